"""What happens when a skill fails again and again although everything it needs seems to hold."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import partial

import pytest

from pix2pred.execution.avoiding import plan_avoiding
from pix2pred.execution.belief.perception import AtTheirWord
from pix2pred.execution.pursuit import MOST_TRIES, MOST_WAYS, GivenUpError, GivingUp, Pursuit
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


def plan_from(doors: Sequence[Object], seen: AbstractState, avoided: Collection[Action] = ()) -> PlanResult:
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
