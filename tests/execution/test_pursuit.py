"""What happens when a skill fails again and again although everything it needs seems to hold."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import partial

import pytest

from pix2pred.execution.avoiding import plan_avoiding
from pix2pred.execution.belief.perception import AtTheirWord
from pix2pred.execution.pursuit import MOST_TRIES, MOST_WAYS, GivenUpError, GivingUp, Licence, Pursuit
from pix2pred.planning import AStar, Planner
from pix2pred.predicates import Labeller, LabelSettings
from pix2pred.structs import (
    AbstractState,
    Action,
    FromDomain,
    LiftedAtom,
    Object,
    Operator,
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
    WorldModel,
)
from pix2pred.vlm import Answer, Request

DOOR = Type("door")
DOORS = tuple(Object(f"d{i}", DOOR) for i in range(5))
X = Variable("?x", DOOR)
SHUT, OUT = Predicate("Shut", (DOOR,), FromDomain()), Predicate("Out", (), FromDomain())
LEAVE, KNOCK = Skill("Leave", (DOOR,)), Skill("Knock", (DOOR,))
GO = Operator(
    "Go", (X,), frozenset({LiftedAtom(SHUT, (X,))}), frozenset({LiftedAtom(OUT, ())}), frozenset(), LEAVE, (X,)
)
MODEL = WorldModel(Vocabulary("doors", (DOOR,), (LEAVE, KNOCK), (SHUT, OUT)), (), (GO,), "told")
ALL_SHUT: AbstractState = frozenset(SHUT(d) for d in DOORS)
GOAL = (OUT(),)


def plan_from(
    doors: Sequence[Object], seen: AbstractState, avoided: Collection[Action] = (), licence: Licence = Licence.LEARNED
) -> PlanResult:
    return plan_avoiding(Planner(AStar()), (GO,), doors, seen, GOAL, avoided)


def test_a_plan_avoids_actions_and_keeps_the_operators_as_they_were() -> None:
    found = plan_from(DOORS, ALL_SHUT, [Action(LEAVE, (d,)) for d in DOORS[:3]])
    assert found.status == PlanStatus.SOLVED and str(found.plan[0]) in ("Go(d3)", "Go(d4)")
    assert found.plan[0].operator is GO
    assert plan_from(DOORS, ALL_SHUT, [Action(LEAVE, (d,)) for d in DOORS]).status == PlanStatus.UNSOLVABLE
    assert plan_from(DOORS, ALL_SHUT, [Action(KNOCK, (d,)) for d in DOORS]).status == PlanStatus.SOLVED


class Silent:
    name = "silent"

    def answer(self, request: Request) -> Answer:
        raise AssertionError("nothing is asked of a model here")


def tried(doors: tuple[Object, ...]) -> tuple[list[str], list[Turn], GivenUpError]:
    """What is tried when every action fails and nothing changes."""
    task = Task("leave", doors, State(given=frozenset(SHUT(d) for d in doors)), GOAL)
    perception = AtTheirWord(MODEL, task, Labeller(Silent(), LabelSettings()))
    state = perception.start(task.initial)
    make = partial(plan_from, doors)
    pursuit = Pursuit(make, [GOAL], make(state).plan, perception)
    steps, turns = list[str](), list[Turn]()
    with pytest.raises(GivenUpError) as caught:
        while (step := pursuit.next()) is not None:
            steps.append(str(step))
            turns.append(pursuit.turn)
            perception.advance(step, task.initial, None)
            pursuit.executed(state, succeeded=False)
    return steps, turns, caught.value


def test_other_ways_are_tried_when_a_skill_keeps_failing_and_the_episode_ends_after_some() -> None:
    steps, turns, error = tried(DOORS)
    assert len(set(steps)) == MOST_WAYS and all(steps.count(s) == MOST_TRIES for s in steps)
    assert turns[MOST_TRIES] == Turn.OTHERWISE and turns[:MOST_TRIES] == [Turn.FOLLOWED, *[Turn.REPEATED] * 2]
    assert error.kind == GivingUp.STUCK and f"Leave({steps[-1][3:-1]}) failed again" in str(error)


def test_without_another_way_the_episode_ends_at_once() -> None:
    steps, _, error = tried(DOORS[:1])
    assert steps == ["Go(d0)"] * MOST_TRIES and error.kind == GivingUp.STUCK


BOX, BALL, HAND = Type("box"), Type("ball"), Type("hand")
H, B0, B1, O0 = Object("h", HAND), Object("b0", BALL), Object("b1", BALL), Object("o0", BOX)
HOLDING, INSIDE = Predicate("Holding", (HAND, BALL), FromDomain()), Predicate("Inside", (BALL, BOX), FromDomain())
GRASP, TIP = Skill("Grasp", (HAND, BALL)), Skill("Tip", (HAND, BOX))
HH, BB, OO = Variable("?h", HAND), Variable("?b", BALL), Variable("?o", BOX)
GRASPED = Operator(
    "Grasped", (HH, BB), frozenset(), frozenset({LiftedAtom(HOLDING, (HH, BB))}), frozenset(), GRASP, (HH, BB)
)
"""Learned without the precondition that the ball must not be inside a box."""

TIPPED = Operator(
    "Tipped", (HH, BB, OO), frozenset({LiftedAtom(INSIDE, (BB, OO))}), frozenset(),
    frozenset({LiftedAtom(INSIDE, (BB, OO))}), TIP, (HH, OO),
)  # fmt: skip


def planned(seen: AbstractState, avoided: Collection[Action] = (), licence: Licence = Licence.LEARNED) -> PlanResult:
    changed = licence is Licence.AFTER_A_CHANGE
    parts = (Planner(AStar()), (GRASPED, TIPPED), (H, B0, B1, O0), seen, (HOLDING(H, B0),))
    return plan_avoiding(*parts, avoided, until_changed=changed)


def test_what_fails_is_planned_again_after_something_about_its_objects_has_changed() -> None:
    grasp, inside = Action(GRASP, (H, B0)), frozenset({INSIDE(B0, O0), INSIDE(B1, O0)})
    assert planned(inside, [grasp]).status == PlanStatus.UNSOLVABLE
    found = planned(inside, [grasp], Licence.AFTER_A_CHANGE)
    assert [str(s) for s in found.plan] == ["Tipped(h, b0, o0)", "Grasped(h, b0)"]
    assert [s.operator for s in found.plan] == [TIPPED, GRASPED]
    elsewhere = planned(frozenset({INSIDE(B1, O0)}), [grasp], Licence.AFTER_A_CHANGE)
    assert elsewhere.status == PlanStatus.UNSOLVABLE, "neither another ball nor the hand counts"


def test_a_missing_precondition_is_found_out_by_changing_what_there_is_to_change() -> None:
    model = WorldModel(Vocabulary("balls", (BOX, BALL, HAND), (GRASP, TIP), (HOLDING, INSIDE)), (), (), "told")
    state: AbstractState = frozenset({INSIDE(B0, O0)})
    task = Task("grasp", (H, B0, B1, O0), State(given=state), (HOLDING(H, B0),))
    perception = AtTheirWord(model, task, Labeller(Silent(), LabelSettings()))
    perception.start(task.initial)
    pursuit = Pursuit(planned, task.goals, planned(state).plan, perception, resourceful=True)
    steps = list[str]()
    while (step := pursuit.next()) is not None:
        steps.append(str(step))
        before, works = state, step.operator is TIPPED or not state
        state = (state - step.delete) | step.add if works else state
        perception.advance(step, State(given=state), None)
        pursuit.executed(before, succeeded=works)
    assert steps == [*["Grasped(h, b0)"] * MOST_TRIES, "Tipped(h, b0, o0)", "Grasped(h, b0)"]
