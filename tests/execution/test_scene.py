"""What a plan rests on and why there is none, on a world small enough to work out by hand."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import pytest

from pix2pred.execution import Guided, PlannedScene, Solver, plan_scene
from pix2pred.execution.belief.perception import AtTheirWord
from pix2pred.execution.explaining.diagnosis import correct_labels
from pix2pred.execution.explaining.missing import missing
from pix2pred.execution.explaining.rests import Need, needs
from pix2pred.execution.explaining.wording import in_words
from pix2pred.planning import AStar, Planner
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.planning.pddl.steps import read_plan
from pix2pred.planning.pddl.write import write_domain, write_plan, write_problem
from pix2pred.predicates import Labeller, LabelSettings, UnusableAnswersError
from pix2pred.structs import (
    Atom,
    FromHuman,
    FromVLM,
    Image,
    LiftedAtom,
    Object,
    Operator,
    Picture,
    PlanStatus,
    Predicate,
    Skill,
    State,
    Task,
    Type,
    Variable,
    Vocabulary,
    WorldModel,
)
from pix2pred.structs.goals.opposites import contrary, is_denial, with_denials
from pix2pred.structs.plans import effects, signed
from pix2pred.vlm import Answer, Request
from pix2pred.vlm.offline.prompt_format import asked_atoms

CUP, KETTLE = Type("cup"), Type("kettle")
C1, C2, K = Object("c1", CUP, "blue cup"), Object("c2", CUP), Object("k", KETTLE)
HOT = Predicate("hot0", (KETTLE,), FromVLM("hot"))
FULL = Predicate("full0", (CUP,), FromVLM("full"))
EMPTY = Predicate("empty0", (CUP,), FromVLM("empty"))
SERVED = Predicate("Served", (CUP,), FromHuman())
X, Y = Variable("?x", KETTLE), Variable("?y", CUP)
HEAT, POUR, SERVE = Skill("Heat", (KETTLE,)), Skill("PourInto", (KETTLE, CUP)), Skill("Serve", (CUP,))


def lifted(predicate: Predicate, *variables: Variable) -> LiftedAtom:
    return LiftedAtom(predicate, variables)


def operator(name: str, skill: Skill, pre: set[LiftedAtom], add: set[LiftedAtom], delete: set[LiftedAtom]) -> Operator:
    used = tuple(v for v in (X, Y) if v.type in skill.types)
    return Operator(name, used, frozenset(pre), frozenset(add), frozenset(delete), skill, used)


OPERATORS = (
    operator("Op0", HEAT, set(), {lifted(HOT, X)}, set()),
    operator("Op1", POUR, {lifted(HOT, X), lifted(EMPTY, Y)}, {lifted(FULL, Y)}, {lifted(HOT, X), lifted(EMPTY, Y)}),
    operator("Op2", SERVE, {lifted(FULL, Y)}, {lifted(SERVED, Y)}, set()),
)
VOCABULARY = Vocabulary("tea", (CUP, KETTLE), (HEAT, POUR, SERVE), (SERVED,))
MODEL = WorldModel(VOCABULARY, (EMPTY, FULL, HOT), OPERATORS, "told")


@dataclass
class Told:
    """Answers with ``values``, picture by picture; what is not in them gets no line."""

    values: list[dict[str, str]]
    name: str = "told"
    asked: list[Request] = field(default_factory=list)

    def answer(self, request: Request) -> Answer:
        self.asked.append(request)
        state = max(v.state for v in request.views)
        known = self.values[min(state, len(self.values) - 1)]
        lines = [f"* {a}: {known[str(a)]}. I see it." for a in asked_atoms(request.text) if str(a) in known]
        return Answer("\n".join(lines))


def photo(shade: int) -> State:
    import numpy as np

    return State((Picture("main", Image.from_pixels(np.full((8, 8, 3), shade, np.uint8))),))


def task(*goal: Atom) -> Task:
    return Task("monday", (C1, C2, K), photo(0), goal)


COLD = {
    "hot(k)": "False",
    "full(blue_cup)": "False",
    "full(c2)": "False",
    "empty(blue_cup)": "True",
    "empty(c2)": "True",
}


def scene(*goal: Atom, **different: str) -> PlannedScene:
    values = {k: v for k, v in (COLD | {k.replace("_of_", "(") + ")": v for k, v in different.items()}).items() if v}
    return planned([values], *goal)


def planned(values: list[dict[str, str]], *goal: Atom) -> PlannedScene:
    labels = LabelSettings(crops=False, marks=False)
    return plan_scene(Solver(MODEL, Planner(AStar()), Labeller(Told(values), labels)), task(*goal))


def test_each_need_comes_from_a_step_or_from_the_first_look() -> None:
    found = scene(SERVED(C1), SERVED(C2))
    first, second = (found.actions.index(f"PourInto(k, {c})") for c in ("c1", "c2"))
    assert len(found.actions) == 6
    by_step = [{str(n.atom): n.by for n in step} for step in found.needs]
    heats = [i for i, action in enumerate(found.actions) if action == "Heat(k)"]
    for pour in (first, second):  # hot water is used up: each pouring needs the heating just before it
        assert by_step[pour]["hot0(k)"] == max(h for h in heats if h < pour)
    assert by_step[first]["empty0(c1)"] is None and by_step[second]["empty0(c2)"] is None
    assert by_step[found.actions.index("Serve(c1)")] == {"full0(c1)": first}
    assert set(by_step[-1]) == {"Served(c1)", "Served(c2)"} and None not in by_step[-1].values()
    assert [str(a) for a in found.rests_on] == ["empty0(c1)", "empty0(c2)"]
    assert found.said[EMPTY(C1)] == "I see it."


def test_an_atom_that_is_deleted_and_never_made_again_is_not_taken_from_the_start() -> None:
    pour = OPERATORS[1].ground((K, C1))
    assert needs([pour], [FULL(C1)]) == ((Need(EMPTY(C1), None), Need(HOT(K), None)), (Need(FULL(C1), 0),))


def test_a_goal_that_holds_needs_no_step() -> None:
    found = scene(FULL(C1), full_of_blue_cup="True")
    assert (found.solved, found.actions) == (True, ())
    assert [str(a) for a in found.rests_on] == ["full0(c1)"]


def test_what_is_missing_is_followed_from_the_goal_to_what_was_not_seen() -> None:
    found = scene(SERVED(C1), SERVED(C2), empty_of_c2="False")
    assert found.result.status == PlanStatus.UNSOLVABLE and not found.rests_on
    chain = [(str(m.atom), str(m.step) if m.step else None, [str(a) for a in m.lacks]) for m in found.missing]
    assert chain == [
        ("Served(c2)", "Op2(c2)", ["full0(c2)"]),
        ("full0(c2)", "Op1(k, c2)", ["empty0(c2)"]),
        ("empty0(c2)", None, []),
    ]
    assert found.unlabelled == () and found.would_help == ()


@pytest.mark.parametrize("answer", ["Unknown", ""])
def test_an_atom_without_a_label_is_false_but_named_and_tried(answer: str) -> None:
    found = scene(SERVED(C2), empty_of_c2=answer)
    assert found.result.status == PlanStatus.UNSOLVABLE
    assert [str(a) for a in found.unlabelled] == ["empty0(c2)"]
    assert [str(a) for a in found.would_help] == ["empty0(c2)"]
    assert scene(SERVED(C1), empty_of_c2=answer).would_help == ()  # there is a plan


@dataclass
class ToldLater(Told):
    """Says ``again`` to what is asked after the first question."""

    again: str = "False"

    def answer(self, request: Request) -> Answer:
        first = super().answer(request)
        return (
            first if len(self.asked) == 1 else Answer(f"* {next(asked_atoms(request.text))}: {self.again}. I see it.")
        )


@pytest.mark.parametrize(("again", "without"), [("False", []), ("Unknown", ["empty0(c2)"])])
def test_an_atom_that_has_a_value_when_asked_again_is_not_without_one(again: str, without: list[str]) -> None:
    vlm = ToldLater([COLD | {"empty(c2)": "Unknown"}], again=again)
    solver = Solver(MODEL, Planner(AStar()), Labeller(vlm, LabelSettings(crops=False, marks=False)))
    found = plan_scene(solver, task(SERVED(C2)))
    assert len(vlm.asked) > 1 and [str(a) for a in found.unlabelled] == without


def test_goals_that_exclude_one_another_lack_nothing() -> None:
    assert missing(OPERATORS, (C1, C2, K), frozenset({EMPTY(C1)}), [FULL(C1), EMPTY(C1)]) == ()
    assert scene(FULL(C1), EMPTY(C1)).missing == ()


def test_no_answer_at_all_is_an_error() -> None:
    with pytest.raises(UnusableAnswersError):
        planned([{}], SERVED(C1))


def test_a_step_in_words_uses_descriptors() -> None:
    assert in_words(OPERATORS[1].ground((K, C1))) == "Pour into: k, blue cup (c1)"


HOT_NOW = COLD | {"hot(k)": "True"}
POURED = COLD | {"full(blue_cup)": "True", "empty(blue_cup)": "False"}


def test_a_guided_execution_compares_and_plans_again() -> None:
    guided = Guided(planned([COLD, COLD, HOT_NOW, POURED, POURED], SERVED(C1)))
    assert [s.operator.name for s in guided.remaining] == ["Op0", "Op1", "Op2"]
    look = guided.observe(photo(1), told=False)  # the kettle stayed cold
    assert (signed(look.absent), look.surplus, look.replanned) == (("+hot0(k)",), (), True)
    assert guided.observe(photo(2), told=False).absent == ()
    look = guided.observe(photo(3), told=False)
    assert (signed(look.expected), look.absent) == (("+full0(c1)", "-empty0(c1)", "-hot0(k)"), ())
    assert signed(guided.expected_listed) == ("+Served(c1)",)
    look = guided.observe(photo(4), told=False)  # no photo shows whether it was served
    assert signed(look.assumed) == ("+Served(c1)",) and guided.reached
    assert (guided.step, guided.ended, guided.replans) == (None, "", 1)


def test_what_no_photo_shows_is_not_assumed_when_the_rest_of_the_step_failed() -> None:
    serve = operator("Op2", SERVE, {lifted(FULL, Y)}, {lifted(SERVED, Y), lifted(EMPTY, Y)}, {lifted(FULL, Y)})
    model = WorldModel(VOCABULARY, (EMPTY, FULL, HOT), (*OPERATORS[:2], serve), "told")
    solver = Solver(model, Planner(AStar()), Labeller(Told([POURED]), LabelSettings(crops=False)))
    guided = Guided(plan_scene(solver, task(SERVED(C1))))
    look = guided.observe(photo(1), told=False)
    assert signed(look.absent) == ("+Served(c1)", "+empty0(c1)", "-full0(c1)") and look.assumed == ()
    guided.observe(photo(2), told=False)
    guided.observe(photo(3), told=False)  # failed a third time in a state that looks the same
    assert guided.step is None and "failed again" in guided.ended and not guided.reached


def test_what_a_person_tells_counts() -> None:
    guided = Guided(planned([POURED], SERVED(C1)))
    assert guided.told(photo(1), ()).given == frozenset()
    state = guided.told(photo(1), guided.expected_listed)
    assert state.given == {SERVED(C1)}
    look = guided.observe(state, told=True)
    assert guided.reached and look.assumed == ()


def test_a_goal_may_say_what_must_not_hold() -> None:
    found = scene(SERVED(C1), contrary(HOT(K)), contrary(EMPTY(C2)))
    assert found.solved and [str(a) for a in found.task.goal] == ["Served(c1)", "not hot0(k)", "not empty0(c2)"]
    end = found.seen
    for step in found.result.plan:
        assert step.applicable(end)
        end = step.apply(end)
    assert SERVED(C1) in end and FULL(C2) in end and HOT(K) not in end, "the water that was heated is used up"
    assert [str(n.atom) for n in found.needs[-1]] == ["Served(c1)", "not empty0(c2)", "not hot0(k)"]
    assert not any(is_denial(change.atom) for step in found.result.plan for change in effects(step))


def test_labels_put_right_are_right_about_opposites() -> None:
    seen = with_denials(frozenset({HOT(K), EMPTY(C1)}), {HOT, FULL}, (C1, K))
    right = correct_labels(seen, {HOT(K): False, FULL(C1): True, EMPTY(C1): False}, frozenset({HOT, FULL}))
    assert right == with_denials(frozenset({FULL(C1)}), {HOT, FULL}, (C1, K))


def test_what_must_not_hold_and_does_not_needs_no_step() -> None:
    found = scene(contrary(HOT(K)))
    assert found.solved and not found.result.plan and found.rests_on == (contrary(HOT(K)),)


def test_what_cannot_be_undone_is_named_as_missing() -> None:
    found = scene(contrary(FULL(C1)), full_of_blue_cup="True", empty_of_blue_cup="False")
    assert not found.solved and [str(m.atom) for m in found.missing] == ["not full0(c1)"]


def test_of_several_goals_the_one_with_the_shortest_plan_is_followed() -> None:
    solver = Solver(MODEL, Planner(AStar()), Labeller(Told([COLD]), LabelSettings(crops=False, marks=False)))
    several = Task("monday", (C1, C2, K), photo(0), (SERVED(C1),), ((FULL(C2),), (contrary(FULL(C1)), HOT(K))))
    found = plan_scene(solver, several)
    assert found.task.goal == (contrary(FULL(C1)), HOT(K)) and found.actions == ("Heat(k)",)
    impossible = Predicate("Broken", (CUP,), FromHuman())
    none = plan_scene(solver, replace(several, goal=(impossible(C1),), alternatives=((impossible(C2),),)))
    assert none.task.goal == (impossible(C1),) and none.result.status == PlanStatus.UNSOLVABLE


def test_the_way_to_a_goal_with_or_may_change_when_a_step_fails() -> None:
    hot = COLD | {"hot(k)": "True"}
    spilt = COLD | {"full(blue_cup)": "True", "empty(blue_cup)": "False"}  # into the other cup
    labeller = Labeller(Told([hot, spilt]), LabelSettings(crops=False, marks=False))
    solver = Solver(MODEL, Planner(AStar()), labeller, perceiving=AtTheirWord)
    asked = Task("monday", (C1, C2, K), photo(0), (SERVED(C1),), ((FULL(C2),),))
    guided = Guided(plan_scene(solver, asked))
    assert guided.scene.task.goal == (FULL(C2),) and [str(s) for s in guided.remaining] == ["Op1(k, c2)"]
    look = guided.observe(photo(1), told=False)
    assert look.replanned and [str(s) for s in guided.remaining] == ["Op2(c1)"] and not guided.reached
    guided.observe(guided.told(photo(2), guided.expected_listed), told=True)
    assert guided.reached and guided.step is None and not guided.ended


def test_goals_with_not_are_followed_photo_by_photo_and_held_to() -> None:
    hot = COLD | {"hot(k)": "True"}
    poured = COLD | {"full(blue_cup)": "True", "empty(blue_cup)": "False"}
    for shown, done in ((hot, False), (poured, True)):
        found = planned([hot, shown], contrary(HOT(K)))
        assert found.actions == ("PourInto(k, c1)",)
        guided = Guided(found)
        look = guided.observe(photo(1), told=False)
        assert (guided.reached, guided.step is None, bool(look.absent)) == (done, done, not done)
        assert not any(is_denial(c.atom) for c in (*look.expected, *look.absent, *look.surplus))


def test_goals_with_not_and_or_are_written_as_pddl() -> None:
    found = scene(SERVED(C1), contrary(HOT(K)))
    text = write_problem(MODEL, "monday", found.task.objects, found.seen, found.task.goal)
    domain = read_domain(write_domain(MODEL))
    problem = read_problem(text, domain)
    steps = read_plan(write_plan(MODEL, found.task.objects, found.result.plan), domain, problem)
    assert check_plan(domain, problem, steps).valid and not check_plan(domain, problem, ()).valid
    assert "not hot0" not in text and "(not (" in text
    several = read_problem(
        write_problem(MODEL, "m", (C1, C2, K), frozenset(), [SERVED(C1)], [contrary(HOT(K))]), domain
    )
    assert check_plan(domain, several, ()).valid, "the second goal holds"
