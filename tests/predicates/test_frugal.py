"""The frugal protocol: words with definitions, histories in one answer, and several words at test time."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pix2pred.predicates import (
    LabelProtocol,
    LabelSettings,
    ProposalSettings,
    ground_atoms,
    label_demos,
    labeller_for,
    proposed_pool,
)
from pix2pred.predicates.frugal.definitions import Definition, read_definition
from pix2pred.predicates.frugal.histories import HistoryFormat
from pix2pred.predicates.frugal.proposing import new_kinds, propose_words, read_words
from pix2pred.predicates.labelling.asking import Occurrence
from pix2pred.predicates.prompt import kind_lines, meaning_lines
from pix2pred.predicates.proposing.lift import lift
from pix2pred.structs import Action, Demo, FromVLM, Label, Object, Predicate, Skill, Type
from pix2pred.vlm import Purpose, Request, Together
from pix2pred.vlm.offline.prompt_format import defined_words, previous_values
from predicates.scripted import COOKED, HOLDING, OBJECTS, P1, PATTY, PICK, R, ScriptedVLM, demo, state

T, F, U = Label.TRUE, Label.FALSE, Label.UNKNOWN
FRUGAL = LabelSettings(protocol=LabelProtocol.FRUGAL)
WORDS = "\n".join(
    [
        "Here are the predicates:",
        "* cooked(patty1) | CHANGES | The patty is brown, also while it is held. | also: grilled, browned"
        " | opposite: raw",
        "* grilled(patty1) | CHANGES | A second word.",
        "* meaty(patty2) | STAYS | It is made of meat.",
        "* flies(bird) | CHANGES | It flies.",
        "In short, cooked(patty2) and meaty(patty1) matter.",
    ]
)


def test_a_proposal_gives_words_meanings_and_what_never_changes() -> None:
    proposal = read_words(demo(), WORDS, ProposalSettings())
    assert [a.name for a in proposal.accepted] == ["cooked", "grilled", "meaty"]
    assert proposal.accepted[0].definition == Definition(
        "The patty is brown, also while it is held.", True, ("grilled", "browned"), ("raw",)
    )
    assert [r.text for r in proposal.rejected] == ["flies(bird)"]
    assert [(c.predicate.name, c.predicate.source, c.predicate.description) for c in lift([proposal])] == [
        ("cooked0", FromVLM("cooked", ("grilled", "browned"), ("raw",)), "The patty is brown, also while it is held."),
        ("meaty0", FromVLM("meaty", changes=False), "It is made of meat."),
    ]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", Definition()),
        (" | Never changes | Round.", Definition("Round.", False)),
        ("| It is open, or ajar.", Definition("It is open, or ajar.")),
        ("| opposite: not-open, 3x, shut. | CHANGES | Open.", Definition("Open.", True, (), ("not_open", "shut"))),
        ("| CHANGES | It changes when a skill opens it.", Definition("It changes when a skill opens it.")),
    ],
)
def test_definitions_are_read_in_any_order_and_with_gaps(text: str, expected: Definition) -> None:
    assert read_definition(text) == expected


def test_a_later_question_tells_the_words_so_far_and_only_new_kinds_are_asked_about() -> None:
    other = demo(name="other")
    wipe = Skill("Wipe", (PATTY,), description="Wipes it.")
    wiped = Demo("wiped", OBJECTS, other.states[:2], (Action(wipe, (P1,)),), ())
    demos = [demo(name="first"), other, wiped]
    assert [d.name for d in new_kinds(demos)] == ["first", "wiped"]
    vlm = ScriptedVLM([WORDS, "* wiped(patty1) | CHANGES | It has been wiped."])
    proposals = propose_words(demos, vlm, ProposalSettings())
    first, second = vlm.asked
    assert "(nothing)\n</defined>" in first.text
    assert (
        "<defined>\n- cooked(patty) | CHANGES | The patty is brown, also while it is held. | also: grilled, browned | "
        "opposite: raw\n- meaty(patty) | STAYS | It is made of meat.\n</defined>"
    ) in second.text
    assert defined_words(second.text) == {("cooked", ("patty",)), ("meaty", ("patty",))}, "readers see them, too"
    assert [view.heading for view in second.views] == ["state 0, camera main", "state 1 after skill 0, camera main"]
    assert "- Wipe(patty): Wipes it." in second.text
    assert {c.predicate.name for c in lift(proposals)} == {"cooked0", "meaty0", "wiped0"}


@pytest.mark.parametrize("meaning", ["...", "(…)", "<meaning>", "Same as above.", "see above", "TBD", "n/a"])
def test_a_placeholder_is_no_meaning(meaning: str) -> None:
    line = f"* cooked(patty1) | CHANGES | {meaning}"
    only = read_words(demo(), line, ProposalSettings())
    assert not only.accepted and [r.reason for r in only.rejected] == ["its meaning is a placeholder"]
    both = read_words(demo(), f"{line}\n* cooked(patty2) | CHANGES | Brown.", ProposalSettings())
    assert [o.prompt_name for a in both.accepted for o in a.objects] == ["patty2", "patty1"]
    assert [c.predicate.description for c in lift([both])] == ["Brown."]


def test_an_answer_of_placeholders_alone_is_asked_for_again() -> None:
    vlm = ScriptedVLM(["* cooked(patty1) | CHANGES | ...", WORDS])
    (proposal,) = propose_words([demo()], vlm, ProposalSettings())
    assert [request.attempt for request in vlm.asked] == [0, 1]
    assert [a.name for a in proposal.accepted] == ["cooked", "grilled", "meaty"]


def test_what_is_known_from_elsewhere_gets_no_second_word() -> None:
    lines = "* Holding(robot, patty1) | CHANGES | It is held.\n* HOLD_ing(robot, patty2) | CHANGES | Held."
    lines += "\n* holding(patty1, patty2) | CHANGES | The first lies on the second."
    proposal = read_words(demo(), lines, ProposalSettings(), [HOLDING])
    assert [(a.name, len(a.objects)) for a in proposal.accepted] == [("holding", 2)]
    assert {r.reason for r in proposal.rejected} == {"Holding is known from elsewhere"}


def test_questions_say_what_types_mean() -> None:
    item = Type("item", description="What can be carried.")
    cup = Type("cup", parent=item)
    assert [line for line in kind_lines([Object("c", cup)]).splitlines() if line] == [
        "More general types, and what belongs to each:",
        "- item: cup",
        "What types mean:",
        "- item = What can be carried.",
    ]
    assert kind_lines([Object("c", Type("cup", parent=Type("item")))]).splitlines()[1:] == [
        "More general types, and what belongs to each:",
        "- item: cup",
    ]
    assert kind_lines([R]) == ""


def test_meanings_are_told_once_for_several_types() -> None:
    near = [
        Predicate(f"near{i}", (t,), FromVLM("near", changes=False), "Close by.") for i, t in enumerate((PATTY, R.type))
    ]
    assert meaning_lines(near) == "- near(patty), (robot): Close by. It never changes."


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("* cooked(p1): False", (F, F, F)),
        ("cooked(p1): False; 3 True", (F, T, T)),
        ("- **cooked(p1)**: True; 3 False; 4 Unknown.", (T, F, U)),
        ("* cooked(p1): False; True from state 4", (F, F, T)),
        ("* Cooked( p1 ): unknown, 4: true", (U, U, T)),
        ("* cooked(p1): False; 9 True", None),
        ("* cooked(p1): maybe; 3 True", None),
        ("* cooked(p1): False; 3", None),
        ("As cooked(p1): True says", None),
    ],
)
def test_histories_are_read_and_what_is_odd_gives_no_value(line: str, expected: tuple[Label, ...] | None) -> None:
    parsed = HistoryFormat((2, 3, 4)).read(line, ["cooked(p1)"])
    assert parsed.values.get("cooked(p1)") == expected
    assert parsed.missing == (() if expected else ("cooked(p1)",))


def test_one_question_labels_all_states_and_asks_again_for_what_is_missing() -> None:
    vlm = ScriptedVLM(["* cooked(patty1): False; 2 True", "* cooked(patty2): True"])
    d = demo(actions=2)
    labels = labeller_for(vlm, FRUGAL).demo(d, ground_atoms([COOKED], d.objects))
    assert [[s.values[a] for a in sorted(s.values)] for s in labels] == [[F, T], [F, T], [T, T]]
    assert [request.purpose for request in vlm.asked] == [Purpose.HISTORY] * 2
    assert vlm.asked[1].text.rpartition("Predicates:\n")[2].split() == ["cooked(patty2)"]
    headings = [v.heading for v in vlm.asked[0].views if v.crop is None]
    assert headings == [f"state {t}, camera main" for t in ("0", "1 after skill 0", "2 after skill 1")]
    assert labels[-1].counts[Occurrence.READ] == 2 and not labels[-1].gaps


def test_only_skills_of_which_something_is_said_are_told_beside_the_executed_ones() -> None:
    vlm = ScriptedVLM(lambda request: "* cooked(patty1): True\n* cooked(patty2): True")
    bare = demo(actions=1)
    told = replace(PICK, description="The robot takes what nothing lies on.")
    for skill in (PICK, told):
        one = replace(bare, actions=tuple(replace(a, skill=skill) for a in bare.actions))
        labeller_for(vlm, FRUGAL).demo(one, ground_atoms([COOKED], OBJECTS))
    without, told_text = (request.text for request in vlm.asked)
    assert without.count("Pick") == 1 and "Skills of the robot" not in without
    assert "Skills of the robot:\n- Pick(robot, item): The robot takes what nothing lies on.\n" in told_text


def test_long_demonstrations_are_asked_about_in_stretches_that_share_a_state() -> None:
    answers = ["* cooked(patty1): False; 1 True", "* cooked(patty1): True; 3 False", "* cooked(patty1): False"]
    vlm = ScriptedVLM(answers)
    d = demo(actions=4)
    settings = FRUGAL.model_copy(update={"states_per_query": 3, "attempts": 1})
    labels = labeller_for(vlm, settings).demo(d, [COOKED(P1)])
    assert [s.values[COOKED(P1)] for s in labels] == [F, T, T, F, F]
    assert "Values in state 2, as answered earlier:\n<previous>\ncooked(patty1): True\nAll other" in vlm.asked[1].text


def test_what_was_false_before_is_listed_once_and_read_all_the_same() -> None:
    first = "* cooked(patty1): False; 2 Unknown\n* cooked(patty2): False"
    vlm = ScriptedVLM([first, "* cooked(patty1): True\n* cooked(patty2): True"])
    settings = FRUGAL.model_copy(update={"states_per_query": 3, "attempts": 1})
    other = Object("patty2", PATTY)
    labeller_for(vlm, settings).demo(demo(actions=4), [COOKED(P1), COOKED(other)])
    text = vlm.asked[1].text
    assert text.count("cooked(patty2)") == 1 and text.count("cooked(patty1)") == 2
    assert previous_values(text) == {"cooked(patty1)": "Unknown", "cooked(patty2)": "False"}


def seen_in_pictures(request: Request) -> str:
    """Words for proposals; patty1 is cooked from state 3 on and patty2 never."""
    if request.purpose == Purpose.DEFINE:
        return WORDS
    first, *later = sorted({v.state for v in request.views})
    told = f"{first >= 3}" + ("; 3 True" if first < 3 and 3 in later else "")
    asked = request.text.rpartition("Predicates:\n")[2].split()
    return "\n".join(f"* {atom}: {told if 'patty1' in atom else False}" for atom in asked)


@pytest.mark.parametrize("crops", [True, False])
@pytest.mark.parametrize("most", [3, 4, 5, 8])
def test_no_question_shows_more_than_the_most_pictures(most: int, crops: bool) -> None:
    """Words are asked for in parts, each told the words before; states are labelled in shorter stretches."""
    d, atoms = demo(actions=7), ground_atoms([COOKED], OBJECTS)
    settings = FRUGAL.model_copy(update={"crops": crops})
    vlm = ScriptedVLM(seen_in_pictures)
    pool, _ = proposed_pool([d], [], vlm, ProposalSettings(), settings, Together(1), max_pictures=most)
    assert [c.predicate.name for c in pool] == ["cooked0", "meaty0"]
    labels = labeller_for(vlm, settings, max_pictures=most).demo(d, atoms)
    assert max(len(r.views) for r in vlm.asked) <= most
    for purpose in (Purpose.DEFINE, Purpose.HISTORY):
        asked = [r for r in vlm.asked if r.purpose == purpose]
        assert {v.state for r in asked for v in r.views} == set(range(8)) and len(asked) >= 8 // most
    whole = labeller_for(ScriptedVLM(seen_in_pictures), settings).demo(d, atoms)
    assert [s.values for s in labels] == [s.values for s in whole]


def test_what_no_answer_gives_keeps_its_value_and_is_named() -> None:
    vlm = ScriptedVLM(lambda request: "I cannot say.")
    labels = labeller_for(vlm, FRUGAL).demo(demo(), [COOKED(P1)])
    assert [s.values[COOKED(P1)] for s in labels] == [F, F, F]
    assert [gap.atoms for gap in labels[-1].gaps] == [("cooked(patty1)",)]
    assert len(vlm.asked) == FRUGAL.attempts


def test_at_test_time_the_majority_of_the_words_for_a_meaning_decides() -> None:
    words = Predicate("cooked0", (PATTY,), FromVLM("cooked", ("grilled",), ("raw",)), "Brown.")
    said = {"cooked": "False", "grilled": "True", "raw": "False"}

    def answer(request: Request) -> str:
        return "\n".join(f"* {word}(patty1): {value}" for word, value in said.items())

    labeller = labeller_for(ScriptedVLM(answer), FRUGAL)
    assert labeller.first(state(0), OBJECTS, [words(P1)]).values == {words(P1): T}
    single = FRUGAL.model_copy(update={"words_per_meaning": 1})
    assert labeller_for(ScriptedVLM(answer), single).first(state(0), OBJECTS, [words(P1)]).values == {words(P1): F}


def test_questions_of_two_demonstrations_begin_alike() -> None:
    vlm = ScriptedVLM(lambda request: "* cooked(patty1): True\n* cooked(patty2): True")
    table = label_demos([demo(name="a"), demo(name="b", actions=3)], [HOLDING], [], labeller_for(vlm, FRUGAL))
    assert not vlm.asked and table.counts == {}
    for one in (demo(name="a"), demo(name="b", actions=3)):
        labeller_for(vlm, FRUGAL).demo(one, ground_atoms([COOKED], OBJECTS))
    a, b = (request.text for request in vlm.asked)
    common = next(i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y)
    assert common > a.index("Executed skills:")
    assert PICK.name in a
