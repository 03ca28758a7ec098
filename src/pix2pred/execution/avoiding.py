"""Plans that leave out certain actions, by any planner: what is left of the operators is written as a precondition."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

from pix2pred.planning import TaskPlanner
from pix2pred.structs import (
    AbstractState,
    Action,
    Atom,
    FromDomain,
    LiftedAtom,
    Object,
    Operator,
    PlanResult,
    Predicate,
    Skill,
    groundings,
)


def plan_avoiding(
    planner: TaskPlanner,
    operators: Sequence[Operator],
    objects: Sequence[Object],
    seen: AbstractState,
    goal: Iterable[Atom],
    avoided: Collection[Action],
) -> PlanResult:
    """A plan from ``seen`` that has none of the actions ``avoided``, with whatever parameters.

    Operators of their skills need a further atom, which is true of all other objects of the skill and never changes.
    """
    permitted = {skill: _permission(skill) for skill in sorted({a.skill for a in avoided})}
    left_out = {(a.skill, a.objects) for a in avoided}
    allowed = {
        Atom(predicate, chosen)
        for skill, predicate in permitted.items()
        for chosen in groundings(skill.types, objects, distinct=False)
        if (skill, chosen) not in left_out
    }
    restricted = [_restricted(o, permitted[o.skill]) if o.skill in permitted else o for o in operators]
    found = planner.plan(restricted, objects, seen | allowed, goal)
    original = {o.name: o for o in operators}
    return replace(found, plan=tuple(original[step.operator.name].ground(step.objects) for step in found.plan))


def _permission(skill: Skill) -> Predicate:
    """No name of a domain has a blank, so that no predicate is called the same."""
    return Predicate(f"may {skill.name}", skill.types, FromDomain())


def _restricted(operator: Operator, permission: Predicate) -> Operator:
    needed = LiftedAtom(permission, operator.skill_args)
    return replace(operator, preconditions=operator.preconditions | {needed})
