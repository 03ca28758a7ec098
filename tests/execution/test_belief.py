"""What is believed given labels that are sometimes wrong: worked by hand, and as laws."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.execution.belief.belief import Belief, Reading
from pix2pred.execution.belief.constraints import Constraints, CountedGroup
from pix2pred.execution.belief.evidence import Answers, log_odds, probability_of
from pix2pred.execution.belief.perception import AtTheirWord, Believing
from pix2pred.execution.doubtful import NearestPlan, nearest_plan, safer_plan
from pix2pred.execution.pursuit import GivenUpError, GivingUp, Licence, Pursuit
from pix2pred.planning import AStar, Planner
from pix2pred.predicates import Labeller, LabelSettings
from pix2pred.structs import (
    AbstractState,
    Action,
    Atom,
    FromDomain,
    FromVLM,
    GroundOperator,
    Image,
    LiftedAtom,
    Object,
    Operator,
    Picture,
    PlanResult,
    PlanStatus,
    Predicate,
    Skill,
    State,
    Task,
    Turn,
    Type,
    Variable,
    Vocabulary,
    WhyAsked,
    WorldModel,
)
from pix2pred.structs.environment import StepStatus
from pix2pred.structs.knowledge import Implication, MutexGroup, Reliability
from pix2pred.vlm import Answer, Request
from pix2pred.vlm.offline.prompt_format import asked_atoms
from pix2pred.vlm.request import Purpose

HAND, THING = Type("hand"), Type("thing")
H, A, B = Object("h", HAND), Object("a", THING), Object("b", THING)
X, Y = Variable("?x", HAND), Variable("?y", THING)
FREE = Predicate("free0", (HAND,), FromVLM("free"))
DONE = Predicate("done0", (THING,), FromVLM("done"))
HOLDING = Predicate("Holding", (HAND, THING), FromDomain())
PACKED = Predicate("Packed", (THING,), FromDomain())
TAKE, PREPARE, PACK = Skill("Take", (HAND, THING)), Skill("Prepare", (THING,)), Skill("Pack", (HAND, THING))


def operator(name: str, skill: Skill, variables: Sequence[Variable], *atoms: set[LiftedAtom]) -> Operator:
    pre, add, delete = (frozenset(group) for group in atoms)
    return Operator(name, tuple(variables), pre, add, delete, skill, tuple(variables))


def lifted(predicate: Predicate, *variables: Variable) -> LiftedAtom:
    return LiftedAtom(predicate, variables)


OPERATORS = (
    operator("Prepare", PREPARE, [Y], set(), {lifted(DONE, Y)}, set()),
    operator("Take", TAKE, [X, Y], {lifted(FREE, X), lifted(DONE, Y)}, {lifted(HOLDING, X, Y)}, {lifted(FREE, X)}),
    operator(
        "Pack", PACK, [X, Y],
        {lifted(HOLDING, X, Y)}, {lifted(PACKED, Y), lifted(FREE, X)}, {lifted(HOLDING, X, Y)},
    ),
)  # fmt: skip
ONE_HAND = MutexGroup((X,), frozenset({lifted(FREE, X), lifted(HOLDING, X, Y)}), True, 100)
PACKED_IS_DONE = Implication(lifted(PACKED, Y), lifted(DONE, Y), 2000)
RELIABILITY = (Reliability(DONE, 0.02, 0.0, 0.02), Reliability(FREE, 0.02, 0.0, 0.95))
VOCABULARY = Vocabulary("packing", (HAND, THING), (TAKE, PREPARE, PACK), (HOLDING, PACKED))
MODEL = WorldModel(VOCABULARY, (DONE, FREE), OPERATORS, "told", RELIABILITY, (ONE_HAND, PACKED_IS_DONE))
PREPARE_A = OPERATORS[0].ground((A,))
TAKE_A = OPERATORS[1].ground((H, A))


def belief() -> Belief:
    return Belief(MODEL, (H, A, B))


def labels(**values: bool) -> dict[Atom, Reading]:
    atoms = {"free": FREE(H), "a": DONE(A), "b": DONE(B)}
    return {atoms[name]: Reading(value) for name, value in values.items()}


def test_a_first_look_weighs_labels_against_first_states_of_demonstrations() -> None:
    found = belief()
    found.start(frozenset(), labels(free=True, a=True))
    error, first = 0.02, 0.02
    expected = first * (1 - error) / (first * (1 - error) + (1 - first) * error)
    assert found.probability(DONE(A)) == pytest.approx(expected)
    assert found.doubted(DONE(A)) and not found.doubted(FREE(H))
    assert found.probability(DONE(B)) == pytest.approx(first), "no label is no evidence"


def test_a_probability_that_was_measured_counts_in_place_of_the_error_rate_of_the_predicate() -> None:
    done = Atom(DONE, (A,))

    def doubt(reading: Reading) -> float:
        found = belief()
        found.start(frozenset(), {done: reading})
        return 1 - found.probability(done)

    word, claimed, measured = (doubt(r) for r in (Reading(True), Reading(True, 0.999), Reading(True, 0.999, True)))
    assert measured < claimed == pytest.approx(word)
    assert (
        doubt(Reading(True, 0.7, True)) == pytest.approx(doubt(Reading(True, 0.7))) and doubt(Reading(True, 0.7)) > word
    )
    assert 0.01 < doubt(Reading(True, 1.0, True)) < claimed  # certainty is never taken at its word


def test_an_invariant_with_a_given_atom_repairs_a_wrong_label() -> None:
    found = belief()
    found.start(frozenset({HOLDING(H, A)}), labels(free=True))
    assert FREE(H) not in found.state and HOLDING(H, A) in found.state
    found = belief()
    found.start(frozenset({PACKED(A)}), labels(free=True, b=False))
    assert DONE(A) in found.state and DONE(B) not in found.state


def test_given_atoms_are_certain_whatever_is_seen() -> None:
    found = belief()
    found.start(frozenset({PACKED(B)}), {})
    assert found.odds(PACKED(B)) == math.inf and found.odds(PACKED(A)) == -math.inf
    assert not found.doubted(PACKED(A))


def test_one_wrong_label_is_not_believed_but_a_change_that_is_seen_again_is() -> None:
    found = belief()
    found.start(frozenset(), labels(free=True, a=False, b=False))
    found.advance(PREPARE_A, StepStatus.DONE, frozenset(), labels(free=True, a=False, b=False))
    assert DONE(A) in found.state
    for _ in range(3):
        found.advance(TAKE_A, None, frozenset(), labels(free=True, a=True, b=True))
    assert DONE(B) in found.state
    found.advance(TAKE_A, None, frozenset(), labels(free=True, a=True, b=False))
    first = found.probability(DONE(B))
    found.advance(TAKE_A, None, frozenset(), labels(free=True, a=True, b=False))
    assert DONE(B) not in found.state and found.probability(DONE(B)) < first


def test_a_given_effect_that_does_not_show_speaks_against_the_preconditions() -> None:
    found = belief()
    found.start(frozenset(), labels(free=True, a=True))
    before = found.probability(DONE(A))
    found.advance(TAKE_A, StepStatus.DONE, frozenset(), labels(free=True))
    assert found.probability(DONE(A)) < 0.8 * before


def test_a_reported_failure_speaks_against_the_preconditions_in_doubt_and_success_does_not() -> None:
    def after(reported: StepStatus) -> float:
        found = belief()
        found.start(frozenset(), labels(a=True))
        polish = operator("Polish", TAKE, [X, Y], {lifted(DONE, Y)}, {lifted(FREE, X)}, set())
        before = found.probability(DONE(A))
        found.advance(polish.ground((H, A)), reported, frozenset(), {})
        return found.probability(DONE(A)) - before

    assert after(StepStatus.STUCK) < -0.1 < after(StepStatus.DONE)


def test_the_same_failure_again_and_the_same_label_of_an_unchanged_scene_tell_nothing_new() -> None:
    polish = operator("Polish", TAKE, [X, Y], {lifted(DONE, Y)}, {lifted(FREE, X)}, set())

    def course(*looks: Mapping[Atom, Reading]) -> list[float]:
        found = belief()
        found.start(frozenset(), labels(a=True))
        probabilities = [found.probability(DONE(A))]
        for readings in looks:
            found.advance(polish.ground((H, A)), StepStatus.STUCK, frozenset(), readings)
            probabilities.append(found.probability(DONE(A)))
        return probabilities

    first, once, twice = course(labels(a=True), labels(a=True))
    assert once < first - 0.1 and twice >= once, "the cause of the first failure is that of the second"
    assert course({}, {}) == pytest.approx([first, once, twice])
    assert course(labels(a=True), labels(a=False))[-1] < twice - 0.1, "another label is news"


def test_an_atom_that_is_always_misread_is_suspected_and_then_no_longer_listened_to() -> None:
    found = belief()
    found.start(frozenset(), labels(free=True, a=False, b=False))
    for _ in range(4):
        found.advance(PREPARE_A, StepStatus.DONE, frozenset(), labels(free=True, a=False, b=False))
    assert found.suspects == (DONE(A),)
    assert DONE(A) in found.state


def test_labels_adjust_the_error_rate_of_their_predicate() -> None:
    found = belief()
    found.start(frozenset(), labels(free=True, a=False, b=False))
    before = found.error(DONE)
    for turn in range(10):
        found.advance(TAKE_A, None, frozenset({HOLDING(H, A)}), labels(a=turn % 2 == 0, b=turn % 2 == 0))
    assert found.error(DONE) > before


@given(st.integers(0, 5), st.integers(0, 5), st.floats(0.001, 0.4), st.floats(0.0, 1.0))
def test_answers_are_weighed_alike_for_both_values(true: int, false: int, error: float, sticky: float) -> None:
    if sticky == 1.0 and true and false:
        return
    one, other = Answers(true, false).log_odds(error, sticky), Answers(false, true).log_odds(error, sticky)
    assert one == pytest.approx(-other, abs=1e-9)
    assert (one > 1e-9) == (true > false) or abs(one) < 1e-6


def test_equal_answers_about_one_picture_add_less_than_the_first() -> None:
    evidence = [Answers(n, 0).log_odds(0.02, 0.5) for n in (1, 2, 3)]
    assert evidence[0] < evidence[1] < evidence[2] < 2 * evidence[0]
    assert Answers(1, 0).plus(False).log_odds(0.02, 0.5) == pytest.approx(0)


@given(st.lists(st.floats(-4, 4), min_size=1, max_size=1), st.lists(st.booleans(), min_size=2, max_size=2))
def test_messages_of_a_group_are_the_exact_posterior(odds: list[float], holding: list[bool]) -> None:
    """One uncertain atom and two given ones: the constraint's weight of each of its two worlds, by hand."""
    certain = frozenset(a for a, held in zip((HOLDING(H, A), HOLDING(H, B)), holding, strict=True) if held)
    constraints = Constraints((ONE_HAND,), (H, A, B), [FREE(H)])
    constraints.given_are(certain)
    weight = {True: 1.0, False: 1 / (ONE_HAND.support + 2)}
    expected = odds[0] + math.log(weight[len(certain) == 0]) - math.log(weight[len(certain) == 1])
    assert constraints.informed(odds)[0] == pytest.approx(expected, abs=0.01)


@given(st.lists(st.floats(-4, 4), min_size=1, max_size=4), st.integers(0, 2), st.booleans(), st.floats(1e-3, 0.2))
def test_given_members_settle_a_group_as_counting_worlds_does(
    odds: list[float], given: int, exactly: bool, broken: float
) -> None:
    """Messages of a group of uncertain members and two given ones, of which ``given`` hold, by its worlds."""
    count = len(odds)
    group = CountedGroup(tuple(range(count + 2)), exactly, broken)
    settled = [g.messages(odds) for g in group.settled(count, set(range(count, count + given)))]
    for i, message in enumerate(settled[0] if settled else [0.0] * count):
        totals = dict.fromkeys((True, False), 0.0)
        for world in product((True, False), repeat=count):
            held = sum(world) + given
            weight = 1.0 if held == 1 or (held == 0 and not exactly) else broken
            totals[world[i]] += weight * math.exp(sum(o for j, o in enumerate(odds) if world[j] and j != i))
        assert message == pytest.approx(math.log(totals[True]) - math.log(totals[False]), abs=1e-6)


def test_probabilities_and_log_odds_are_inverse() -> None:
    for p in (0.001, 0.3, 0.5, 0.97):
        assert probability_of(log_odds(p)) == pytest.approx(p)
    assert probability_of(log_odds(0)) < 1e-8 and probability_of(log_odds(1)) > 1 - 1e-8


@dataclass
class Told:
    """Answers by state and atom; questions asked again get ``again``."""

    values: Sequence[Mapping[str, str]]
    again: Mapping[str, Sequence[str]] = field(default_factory=dict)
    name: str = "told"
    asked: list[Request] = field(default_factory=list)

    def answer(self, request: Request) -> Answer:
        self.asked.append(request)
        state = max(v.state for v in request.views)
        lines = []
        for atom in asked_atoms(request.text):
            value = self.values[min(state, len(self.values) - 1)].get(str(atom), "Unknown")
            if request.purpose == Purpose.ASK_AGAIN:
                number = sum(r.purpose == Purpose.ASK_AGAIN for r in self.asked) - 1
                answers = self.again[str(atom)]
                value = answers[min(number, len(answers) - 1)]
            lines.append(f"* {atom}: {value}. So it looks.")
        return Answer("\n".join(lines))


def photo(shade: int) -> State:
    import numpy as np

    return State((Picture("main", Image.from_pixels(np.full((8, 8, 3), shade, np.uint8))),))


TASK = Task("pack", (H, A, B), photo(0), (PACKED(A),))
START = {"free(h)": "True", "done(a)": "False", "done(b)": "False"}


def plan_from(state: AbstractState, avoided: Collection[Action] = (), licence: Licence = Licence.LEARNED) -> PlanResult:
    return Planner(AStar()).plan(OPERATORS, TASK.objects, state, TASK.goal)


def names(plan: Sequence[GroundOperator]) -> list[str]:
    return [str(step) for step in plan]


def test_a_label_in_doubt_is_asked_about_again_and_the_answer_decides() -> None:
    vlm = Told([START | {"done(a)": "True"}], again={"done(a)": ["False", "False"]})
    perception = Believing()(MODEL, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    assert DONE(A) in perception.start(photo(0)) or perception.doubts([DONE(A)]) == (DONE(A),)
    perception.ask([DONE(A), DONE(A)], WhyAsked.IN_DOUBT)
    (question,) = perception.questions
    assert (question.atom, question.answers, question.state) == (DONE(A), ("false",), 0)
    assert question.after < question.before and DONE(A) not in perception.state


def test_the_budget_of_a_look_bounds_the_questions() -> None:
    vlm = Told([START], again={"done(a)": ["Unknown"], "done(b)": ["Unknown"], "free(h)": ["Unknown"]})
    perception = Believing(ask_again=1)(MODEL, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))
    assert not perception.ask([DONE(A), DONE(B), FREE(H)], WhyAsked.SURPRISE)
    assert [q.atom for q in perception.questions] == [DONE(A)]
    none = Believing(ask_again=0)(MODEL, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    none.start(photo(0))
    none.ask([DONE(A)], WhyAsked.SURPRISE)
    assert none.questions == []


def test_without_doubt_nothing_is_asked_again() -> None:
    vlm = Told([START, START | {"done(a)": "True"}])
    perception = Believing()(MODEL, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))
    pursuit = Pursuit(plan_from, TASK.goals, plan_from(perception.state).plan, perception)
    assert pursuit.next() == PREPARE_A
    perception.advance(PREPARE_A, photo(1), StepStatus.DONE)
    pursuit.executed(frozenset(), succeeded=True)
    assert pursuit.next() == TAKE_A and pursuit.turn == Turn.FOLLOWED
    assert [r.purpose for r in vlm.asked] == [Purpose.LABEL, Purpose.LABEL] and pursuit.replans == 0


def test_without_a_plan_the_nearest_state_with_one_is_asked_about_first() -> None:
    model = WorldModel(VOCABULARY, (DONE, FREE), OPERATORS[1:], "told")  # nothing makes a thing done
    vlm = Told([START], again={"done(a)": ["True", "True"]})
    perception = Believing()(model, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))

    def plan(state: AbstractState) -> PlanResult:
        return Planner(AStar()).plan(OPERATORS[1:], TASK.objects, state, TASK.goal)

    found = nearest_plan(plan, TASK.goals, perception)
    assert found is not None and names(found.found.plan) == ["Take(h, a)", "Pack(h, a)"]
    assert [(q.atom, q.why) for q in perception.questions] == [(DONE(A), WhyAsked.NO_PLAN)]


def test_that_the_goal_holds_is_never_assumed_while_there_is_something_to_do() -> None:
    polish = operator("Polish", PREPARE, [X, Y], {lifted(FREE, X)}, {lifted(DONE, Y)}, set())

    def nearest(*operators: Operator) -> NearestPlan | None:
        model = WorldModel(VOCABULARY, (DONE, FREE), operators, "told")  # even odds before any look
        said = START | {"free(h)": "False"}
        vlm = Told([said], again={"done(a)": ["False", "False"], "free(h)": ["False", "False"]})
        perception = Believing()(model, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
        perception.start(photo(0))
        assert {DONE(A), FREE(H)} <= set(perception.possible())
        planner = Planner(AStar())
        return nearest_plan(lambda now: planner.plan(operators, TASK.objects, now, [DONE(A)]), [[DONE(A)]], perception)

    found = nearest(polish)
    assert found is not None and (names(found.found.plan), found.assumed) == (["Polish(h, a)"], (FREE(H),))
    assert nearest() is None, "nothing makes it done, and to do nothing is no plan"


def test_a_plan_that_does_not_rest_on_what_is_in_doubt_is_taken_when_it_is_cheap() -> None:
    vlm = Told([START | {"done(a)": "True"}])
    perception = Believing(ask_again=0)(MODEL, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))
    doubted = perception.doubts([DONE(A)])
    assert doubted == (DONE(A),)
    at_hand = plan_from(perception.state).plan
    safer = safer_plan(plan_from, TASK.goal, perception, at_hand, doubted)
    assert safer is not None and names(safer.plan) == ["Prepare(a)", "Take(h, a)", "Pack(h, a)"]
    assert safer_plan(plan_from, TASK.goal, perception, safer.plan[:1] * 2, doubted) is None, "it would be longer"
    assert safer_plan(plan_from, TASK.goal, perception, at_hand, ()) is None


def test_a_task_whose_goal_seems_to_hold_without_a_cause_is_not_left() -> None:
    shown = operator("Show", PACK, [X, Y], {lifted(DONE, Y)}, set(), {lifted(DONE, Y)})
    often = (Reliability(DONE, 0.02, 0.0, 0.3), RELIABILITY[1])
    model = WorldModel(VOCABULARY, (DONE, FREE), (OPERATORS[0], shown), "told", often)
    vlm = Told([START | {"done(a)": "True"}], again={"done(a)": ["True", "True"]})
    perception = Believing()(model, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))
    assert DONE(A) in perception.state and perception.doubts([DONE(A)]) == ()

    def plan(state: AbstractState, avoided: Collection[Action] = (), licence: Licence = Licence.LEARNED) -> PlanResult:
        return Planner(AStar()).plan(model.operators, TASK.objects, state, [DONE(A)])

    assert Pursuit(plan, [[DONE(A)]], (), perception).next() is None, "a person who looks on may leave it"
    pursuit = Pursuit(plan, [[DONE(A)]], (), perception, resourceful=True)
    assert pursuit.next() == PREPARE_A and pursuit.turn == Turn.CAUTIOUS and pursuit.because == (DONE(A),)


@pytest.mark.parametrize(("b", "expected"), [("Unknown", DONE(B)), ("False", DONE(A))])
def test_the_likeliest_atoms_are_assumed_and_of_equal_ones_those_with_the_shorter_plan(b: str, expected: Atom) -> None:
    often = (Reliability(DONE, 0.02, 0.0, 0.3), RELIABILITY[1])
    model = WorldModel(VOCABULARY, (DONE, FREE), OPERATORS, "told", often)
    vlm = Told([START | {"done(a)": "Unknown", "done(b)": b}])
    perception = Believing(ask_again=0)(model, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))

    def plan(state: AbstractState) -> PlanResult:
        take = OPERATORS[1].ground
        plan = (take((H, B)),) if DONE(B) in state else (TAKE_A, take((H, A))) if DONE(A) in state else ()
        return PlanResult(PlanStatus.SOLVED if plan else PlanStatus.UNSOLVABLE, plan, 0, 0.0)

    found = nearest_plan(plan, [()], perception)
    assert found is not None and found.assumed == (expected,)


def test_giving_up_has_a_kind_and_a_reason() -> None:
    vlm = Told([START | {"free(h)": "Unknown"}])
    perception = AtTheirWord(MODEL, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))
    pursuit = Pursuit(plan_from, TASK.goals, [PREPARE_A, TAKE_A], perception)
    with pytest.raises(GivenUpError, match=r"no plan any more \(unsolvable\) after Packed|free0\(h\)") as caught:
        pursuit.next()
    assert caught.value.kind == GivingUp.NO_PLAN


def test_the_least_sure_of_what_a_skill_needs_that_fails_again_and_again_is_suspected() -> None:
    model = replace(MODEL, reliability=(Reliability(DONE, 0.02, 0.0, 0.5), RELIABILITY[1]))
    vlm = Told([START | {"done(a)": "True"}])
    perception = Believing(ask_again=0)(model, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))

    def take(state: AbstractState, avoided: Collection[Action] = (), licence: Licence = Licence.LEARNED) -> PlanResult:
        return PlanResult(PlanStatus.UNSOLVABLE if avoided else PlanStatus.SOLVED, () if avoided else (TAKE_A,), 0, 0.0)

    pursuit = Pursuit(take, TASK.goals, [TAKE_A], perception)
    with pytest.raises(GivenUpError) as caught:
        while (step := pursuit.next()) is not None:
            before = perception.state
            perception.advance(step, photo(0), StepStatus.STUCK)
            pursuit.executed(before, succeeded=False)
    assert (caught.value.kind, caught.value.suspects) == (GivingUp.STUCK, (DONE(A),))


@pytest.mark.parametrize("tried", [True, False])
def test_who_decides_is_asked_whether_to_try_what_rests_on_what_is_probably_not_so(tried: bool) -> None:
    polish = operator("Polish", PREPARE, [X, Y], {lifted(FREE, X)}, {lifted(DONE, Y)}, set())
    model = WorldModel(VOCABULARY, (DONE, FREE), (polish,), "told")
    said = START | {"free(h)": "False"}
    vlm = Told([said], again={"done(a)": ["False", "False"], "free(h)": ["False", "False"]})
    perception = Believing()(model, TASK, Labeller(vlm, LabelSettings(crops=False, marks=False)))
    perception.start(photo(0))
    planner, asked = Planner(AStar()), list[object]()

    def decide(atoms: Sequence[Atom]) -> bool:
        asked.extend(atoms)
        return tried

    def plan(now: AbstractState, avoided: Collection[Action] = (), licence: Licence = Licence.LEARNED) -> PlanResult:
        return planner.plan((polish,), TASK.objects, now, [DONE(A)])

    pursuit = Pursuit(plan, [[DONE(A)]], [], perception, may_assume=decide)
    if tried:
        step = pursuit.next()
        assert step is not None and names([step]) == ["Polish(h, a)"] and pursuit.turn == Turn.ASSUMED
    else:
        with pytest.raises(GivenUpError, match="no plan any more"):
            pursuit.next()
    assert asked == [FREE(H)]
