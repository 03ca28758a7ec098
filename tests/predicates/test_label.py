"""Labelling state by state: the chain of answers, pictures, double checks, retries, missing values."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import pytest

from pix2pred.predicates import Labeller, LabelSettings, Occurrence, StateLabels, ground_atoms
from pix2pred.predicates.prompt import atom_text
from pix2pred.structs import Demo, Label
from pix2pred.vlm import Answer, Finish, Purpose, Request, Token
from predicates.scripted import COOKED, OBJECTS, P1, P2, UNDER, Script, ScriptedVLM, demo

ATOMS = ground_atoms((COOKED, UNDER), OBJECTS)
C1, C2 = COOKED(P1), COOKED(P2)
PLAIN = LabelSettings(double_check=False, attempts=1)
ASKING = LabelSettings(double_check=False)


def label(
    script: Script,
    settings: LabelSettings = PLAIN,
    demo: Demo = demo(),  # noqa: B008
) -> tuple[ScriptedVLM, tuple[StateLabels, ...]]:
    vlm = ScriptedVLM(script)
    return vlm, Labeller(vlm, settings).demo(demo, ATOMS)


def values(labels: tuple[StateLabels, ...]) -> list[list[int]]:
    return [[s.values[C1], s.values[C2]] for s in labels]


def test_each_query_holds_the_whole_answer_before() -> None:
    vlm, labels = label([f"Thoughts {t}.\ncooked(patty1): {'True' if t else 'False'}." for t in range(3)])
    first, *later = [r.text for r in vlm.asked]
    assert "Thoughts" not in first
    for t, text in enumerate(later):
        assert f"<previous>\nThoughts {t}.\ncooked(patty1): {'True' if t else 'False'}.\n</previous>" in text
        assert text.count("Thoughts") == 1
    assert [s.text for s in labels] == [f"Thoughts {t}.\ncooked(patty1): {'True' if t else 'False'}." for t in range(3)]
    assert values(labels) == [[0, 0], [1, 0], [1, 0]]


def test_queries_name_things_by_their_descriptors() -> None:
    vlm, _ = label(["cooked(p1): True."] * 3, LabelSettings(double_check=False, attempts=1))
    for request in vlm.asked:
        listed = request.text.rpartition("Predicates:\n")[2].splitlines()
        assert listed == [
            "cooked(patty1)", "cooked(patty2)", "under(patty1, small_blue_cup)", "under(patty2, small_blue_cup)"
        ]  # fmt: skip
        assert "- small_blue_cup (cup)" in request.text
        assert set(request.views[0].boxes) == {"robot", "patty1", "patty2", "small_blue_cup"}
    assert "Executed skill: Pick[robot:robot, patty1:patty]" in vlm.asked[1].text


def test_answers_in_the_words_of_the_query_are_understood() -> None:
    _, labels = label(["under(patty2,Small_blue-cup): True"] * 3)
    assert [a for a, v in labels[0].values.items() if v == Label.TRUE] == [UNDER(P2, OBJECTS[3])]


def test_pictures_are_before_after_and_crops_of_every_camera() -> None:
    vlm, _ = label(["cooked(patty1): True."] * 3, demo=demo(cameras=("l", "r")))
    assert [v.heading for v in vlm.asked[0].views] == ["state 0, camera l", "state 0, camera r"]
    assert [v.heading for v in vlm.asked[2].views] == [
        "before: state 1, camera l", "before: state 1, camera r",
        "after: state 2, camera l", "after: state 2, camera r",
        "before: state 1, camera l, around the skill", "after: state 2, camera l, around the skill",
        "before: state 1, camera r, around the skill", "after: state 2, camera r, around the skill",
    ]  # fmt: skip
    digests = [v.picture.image.digest for v in vlm.asked[2].views]
    assert digests[:4] == [digests[4], digests[6], digests[5], digests[7]]
    crops = {v.crop for v in vlm.asked[2].views[4:]}
    assert len(crops) == 1 and None not in crops, "the same part of all, around the skill's objects"
    assert all(v.crop is None for v in vlm.asked[2].views[:4])


def test_crops_can_be_off_and_need_boxes() -> None:
    vlm, _ = label(["cooked(patty1): True."] * 3, LabelSettings(double_check=False, attempts=1, crops=False))
    assert len(vlm.asked[1].views) == 2
    assert "Two more pictures" not in vlm.asked[1].text
    vlm, _ = label(["cooked(patty1): True."] * 3, demo=demo(boxes=False))
    assert len(vlm.asked[1].views) == 2


def test_the_prompt_does_not_speak_of_pictures_that_are_not_there() -> None:
    vlm, _ = label(["cooked(patty1): True."] * 3, demo=demo(boxes=False))
    assert "Two more pictures" not in vlm.asked[1].text


def by_purpose(first: str, later: str, check: str) -> Callable[[Request], str]:
    def answer(request: Request) -> str:
        if request.purpose == Purpose.DOUBLE_CHECK:
            return check
        return later if "Executed skill" in request.text else first

    return answer


def test_the_double_check_replaces_the_answer_and_is_not_done_at_first() -> None:
    script = by_purpose("cooked(patty1): False. F", "cooked(patty1): False. L", "cooked(patty1): True. C")
    vlm, labels = label(script, LabelSettings(attempts=1))
    assert [r.purpose for r in vlm.asked] == ["label", "label", "double-check", "label", "double-check"]
    assert values(labels) == [[0, 0], [1, 0], [1, 0]]
    assert [s.text[-1] for s in labels] == ["F", "C", "C"]
    check = vlm.asked[2]
    assert check.views == vlm.asked[1].views
    assert f"<question>\n{vlm.asked[1].text}\n</question>" in check.text
    assert "<answer>\ncooked(patty1): False. L\n</answer>" in check.text
    assert "cooked(patty1): False\ncooked(patty2): False\nunder(" in check.text
    assert "<previous>\ncooked(patty1): True. C\n</previous>" in vlm.asked[3].text


def test_a_refused_double_check_keeps_the_answer() -> None:
    _, labels = label(
        by_purpose("cooked(patty1): False.", "cooked(patty1): True.", "Sorry."), LabelSettings(attempts=1)
    )
    assert values(labels)[1] == [Label.TRUE, Label.FALSE]


def test_counts_of_both_answers_are_kept() -> None:
    _, labels = label(by_purpose("", "cooked(patty1): Maybe. cooked(patty2): True.", "cooked(patty1): True."))
    assert labels[1].counts[Occurrence.OTHER_WORDS] == 1
    settings = LabelSettings(attempts=1)
    _, labels = label(by_purpose("", "cooked(patty1): Maybe. cooked(patty2): True.", "cooked(patty1): True."), settings)
    assert labels[1].counts[Occurrence.OTHER_WORDS] == 1


GAPS = [
    "cooked(patty1): True. cooked(patty2): Unknown.",
    "under(patty1, small_blue_cup): True.",
    "cooked(patty1): False",
]


def test_missing_values_are_carried_or_false() -> None:
    _, labels = label(GAPS)
    assert values(labels) == [[Label.TRUE, Label.UNKNOWN], [Label.TRUE, Label.UNKNOWN], [Label.FALSE, Label.UNKNOWN]]
    assert [s.counts[Occurrence.MISSING] for s in labels] == [2, 3, 3]
    _, labels = label(GAPS, LabelSettings(double_check=False, attempts=1, missing="false"))
    assert values(labels) == [[Label.TRUE, Label.UNKNOWN], [Label.FALSE, Label.FALSE], [Label.FALSE, Label.FALSE]]


ALL = "\n".join(
    f"{text}: False" for text in ("cooked(patty2)", "under(patty1, small_blue_cup)", "under(patty2, small_blue_cup)")
)


def test_unusable_answers_are_asked_again_and_counted() -> None:
    whole = f"cooked(patty1): True.\n{ALL}"
    vlm, labels = label(["Sorry.", whole, "", "raw(patty1): True.", "No.", whole], ASKING)
    assert [r.attempt for r in vlm.asked] == [0, 1, 0, 1, 2, 0]
    assert values(labels) == [[Label.TRUE, Label.FALSE]] * 3
    assert [s.counts for s in labels] == [
        {Occurrence.READ: 1, "unusable answers": 1},
        {"unasked": 1, "unusable answers": 3, "missing": 4},
        {Occurrence.READ: 1},
    ]
    (gap,) = labels[1].gaps
    assert (gap.about, gap.purpose, len(gap.atoms)) == ("d, state 1", "label", 4)
    assert not labels[0].gaps and not labels[2].gaps


def test_atoms_left_out_are_asked_about_again_alone() -> None:
    vlm, labels = label(["cooked(patty1): True.", ALL, ALL, "cooked(patty1): Unknown", ALL, "", ""], ASKING)
    listed = [r.text.rpartition("Predicates:\n")[2].splitlines() for r in vlm.asked]
    assert [len(atoms) for atoms in listed] == [4, 3, 4, 1, 4, 1, 1]
    assert values(labels) == [[Label.TRUE, Label.FALSE], [Label.UNKNOWN, Label.FALSE], [Label.UNKNOWN, Label.FALSE]]
    assert labels[0].text == f"cooked(patty1): True.\n\n{ALL}"
    assert [gap.atoms for s in labels for gap in s.gaps] == [("cooked(patty1)",)]


@dataclass
class Finishing:
    """Cuts answers short when they are about more than ``fits`` atoms or their budget is below ``enough``."""

    fits: int
    enough: int = 0
    name: str = "finishing"
    asked: list[int] = field(default_factory=list)

    def answer(self, request: Request) -> Answer:
        atoms = request.text.rpartition("Predicates:\n")[2].splitlines()
        self.asked.append(len(atoms))
        text = "\n".join(f"{atom}: True" for atom in atoms)
        if len(atoms) > self.fits or request.max_tokens < self.enough:
            return Answer(text[: len(text) // 2], finish=Finish.CUT_SHORT)
        return Answer(text)


def test_an_answer_cut_short_is_not_read_and_its_atoms_are_asked_about_in_halves() -> None:
    vlm = Finishing(fits=1)
    labels = Labeller(vlm, ASKING).demo(demo(actions=0), ATOMS)
    assert vlm.asked == [4, 2, 1, 1, 2, 1, 1]
    assert set(labels[0].values.values()) == {Label.TRUE} and not labels[0].gaps
    assert labels[0].counts[Occurrence.CUT_SHORT] == 3


def test_a_single_atom_cut_short_gets_a_larger_budget_and_then_is_given_up() -> None:
    vlm = Finishing(fits=9, enough=4000)
    labels = Labeller(vlm, ASKING).demo(demo(actions=0), ATOMS[:1])
    assert vlm.asked == [1, 1] and not labels[0].gaps
    labels = Labeller(Finishing(fits=0), ASKING).demo(demo(actions=0), ATOMS[:1])
    assert [gap.reason for gap in labels[0].gaps] == ["always cut short"]


class Voting:
    """Says True in samples below ``yes``, False in others; takes no heed of order."""

    name = "voting"

    def __init__(self, yes: int) -> None:
        self.yes = yes
        self.samples: list[tuple[int, float]] = []

    def answer(self, request: Request) -> Answer:
        self.samples.append((request.sample, request.temperature))
        atoms = request.text.rpartition("Predicates:\n")[2].splitlines()
        word = "True" if request.sample < self.yes else "False"
        return Answer("\n".join(f"{atom}: {word}. Sample {request.sample}" for atom in atoms))


@pytest.mark.parametrize(("yes", "value", "share"), [(3, Label.TRUE, 0.6), (1, Label.FALSE, 0.8), (5, Label.TRUE, 1.0)])
def test_votes_decide_and_their_share_is_the_confidence(yes: int, value: int, share: float) -> None:
    vlm = Voting(yes)
    labels = Labeller(vlm, LabelSettings(votes=5)).demo(demo(actions=0), ATOMS)
    assert sorted(vlm.samples) == [(n, 0.7) for n in range(5)]
    assert set(labels[0].values.values()) == {value}
    assert set(labels[0].confidence.values()) == {share}
    assert f"Sample {0 if value == Label.TRUE else yes}" in labels[0].text


def test_confidence_comes_from_the_token_that_begins_the_value() -> None:
    class Sure:
        name = "sure"

        def answer(self, request: Request) -> Answer:
            assert request.logprobs
            pieces: list[tuple[str, list[tuple[str, float]]]] = [("**cooked(patty1)**:", []), (" ", [])]
            pieces += [("Tr", [(" False", 0.2), ("Tr", 0.6), ("maybe", 0.2)]), ("ue", []), (".", [])]
            tokens = [Token(t, ((t, math.log(0.6)), *((o, math.log(p)) for o, p in others))) for t, others in pieces]
            return Answer("".join(t.text for t in tokens), tokens=tuple(tokens))

    labels = Labeller(Sure(), LabelSettings(logprobs=True, attempts=1)).demo(demo(actions=0), ATOMS)
    assert labels[0].confidence == {C1: pytest.approx(0.75)}


def test_structured_answers_are_read_and_prose_in_their_place_too() -> None:
    rows = [{"atom": str(text), "explanation": "seen", "value": "True"} for text in map(atom_text, ATOMS)]
    document = json.dumps({"expected_changes": "a", "observed_changes": "b", "values": rows})
    vlm, labels = label([document, "cooked(patty1): False", document], LabelSettings(
        structured=True, double_check=False, attempts=1))  # fmt: skip
    assert values(labels) == [[Label.TRUE, Label.TRUE], [Label.FALSE, Label.TRUE], [Label.TRUE, Label.TRUE]]
    assert json.loads(vlm.asked[0].schema)["properties"]["values"]["items"]["properties"]["atom"]["enum"]
    assert "* cooked(patty1): True. seen" in vlm.asked[1].text, "the history is told in words"


@pytest.mark.parametrize("size", [1, 2, 3, 4, 100])
def test_long_lists_are_split_and_every_part_sees_the_whole_history(size: int) -> None:
    def answer(request: Request) -> str:
        listed = request.text.rpartition("Predicates:\n")[2].splitlines()
        return "\n".join(f"{atom}: True." for atom in listed)

    settings = LabelSettings(double_check=False, max_atoms_per_query=size)
    vlm, labels = label(answer, settings)
    parts = -(-4 // size)
    assert len(vlm.asked) == 3 * parts
    assert all(set(s.values.values()) == {Label.TRUE} and len(s.values) == 4 for s in labels)
    assert all("under(patty2, small_blue_cup): True." in r.text for r in vlm.asked[parts:])
    assert all("cooked(patty1): True." in r.text for r in vlm.asked[parts:])


def test_the_budget_fits_an_explanation_of_every_atom() -> None:
    vlm, _ = label(["cooked(patty1): True."] * 3)
    assert all(r.max_tokens >= 64 * len(ATOMS) for r in vlm.asked)


def test_hints_and_marks_reach_the_queries() -> None:
    settings = LabelSettings(double_check=False, attempts=1, marks=False, hints=("Cooking is instantaneous.",))
    vlm, _ = label(["cooked(patty1): True."] * 3, settings)
    assert ["Cooking is instantaneous." in r.text for r in vlm.asked] == [False, True, True]
    assert not any(v.marks for r in vlm.asked for v in r.views)


def test_no_atoms_are_not_asked_about() -> None:
    vlm = ScriptedVLM([])
    labels = Labeller(vlm, LabelSettings()).demo(demo(), [])
    assert [s.values for s in labels] == [{}, {}, {}]
    assert vlm.asked == []


def test_states_do_not_share_values() -> None:
    _, labels = label(GAPS)
    labels[0].values[C1] = Label.FALSE
    assert labels[1].values[C1] == Label.TRUE


def test_the_order_of_atoms_does_not_matter() -> None:
    one, other = ScriptedVLM(GAPS), ScriptedVLM(GAPS)
    forth = Labeller(one, PLAIN).demo(demo(), ATOMS)
    back = Labeller(other, PLAIN).demo(demo(), ATOMS[::-1])
    assert [s.values for s in forth] == [s.values for s in back]
    assert [r.key("m") for r in one.asked] == [r.key("m") for r in other.asked]


def test_a_changed_later_state_changes_no_earlier_query() -> None:
    changed = replace(demo(), states=(*demo().states[:2], demo(actions=5).states[5]))
    one, _ = label(GAPS)
    other, _ = label(GAPS, demo=changed)
    same = [a.key("m") == b.key("m") for a, b in zip(one.asked, other.asked, strict=True)]
    assert same == [True, True, False]


def test_every_question_announces_the_pictures_of_the_next_without_being_another_question() -> None:
    vlm, _ = label(lambda request: "cooked(patty1): True.", LabelSettings(attempts=1), demo(actions=3))
    labels = [r for r in vlm.asked if r.purpose == Purpose.LABEL]
    assert [r.upcoming for r in labels] == [*(r.views for r in labels[1:]), ()]
    checks = [r for r in vlm.asked if r.purpose == Purpose.DOUBLE_CHECK]
    assert [r.upcoming for r in checks] == [r.upcoming for r in labels[1:]]
    assert all(replace(r, upcoming=()).key("m") == r.key("m") for r in vlm.asked)
