"""Planning for goals that can be reached in more than one way, or that say what must not hold."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

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
) -> tuple[Goal, PlanResult]:
    """The goal of ``goals`` that takes the fewest steps, the first of such, and its plan.

    Each is planned for by itself. Where none has a plan, it is the first of which it is not certain that there is none.
    The steps of the plan say what becomes of the opposites of atoms that the goals mention.
    """
    there = list(objects)
    denied = denied_in(atom for goal in goals for atom in goal)
    changing = changing_denials(operators, denied)
    state = with_denials(initial, denied, there)
    found = [(goal, planner.plan(changing, there, state, goal)) for goal in goals]
    solved = [f for f in found if f[1].status == PlanStatus.SOLVED]
    if solved:
        return min(solved, key=lambda f: len(f[1].plan))
    return next((f for f in found if f[1].status != PlanStatus.UNSOLVABLE), found[0])
