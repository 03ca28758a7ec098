"""Planning for goals that can be reached in more than one way, or that say what must not hold."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from pix2pred.planning.planner import TaskPlanner
from pix2pred.structs import AbstractState, Atom, Object, Operator, PlanResult, PlanStatus
from pix2pred.structs.goals.opposites import changing_denials, denied_in, with_denials

Goal = tuple[Atom, ...]


def plan_for_any(
    planner: TaskPlanner,
    operators: Sequence[Operator],
    objects: Iterable[Object],
    initial: AbstractState,
    goals: Sequence[Goal],
) -> PlanResult:
    """The plan for one of ``goals``, as ``best_way`` chooses.

    The steps of the plan say what becomes of the opposites of atoms that the goals mention.
    """
    there = list(objects)
    denied = denied_in(atom for goal in goals for atom in goal)
    changing = changing_denials(operators, denied)
    state = with_denials(initial, denied, there)
    return best_way(goals, lambda goal: planner.plan(changing, there, state, goal))


def best_way(goals: Sequence[Goal], plan: Callable[[Goal], PlanResult]) -> PlanResult:
    """Of the plans for ``goals`` the one with the fewest steps, the first of such.

    Where there is no plan, the outcome for the first goal of which it is not certain that it has none.
    """
    found = [replace(plan(goal), goal=goal) for goal in goals]
    solved = [f for f in found if f.status == PlanStatus.SOLVED]
    if solved:
        return min(solved, key=lambda f: len(f.plan))
    return next((f for f in found if f.status != PlanStatus.UNSOLVABLE), found[0])
