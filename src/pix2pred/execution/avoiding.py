"""Plans that leave out certain actions, by any planner: what is left of the operators is written as a precondition."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
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
    Variable,
    groundings,
)


def plan_avoiding(
    planner: TaskPlanner,
    operators: Sequence[Operator],
    objects: Sequence[Object],
    seen: AbstractState,
    goal: Iterable[Atom],
    avoided: Collection[Action],
    *,
    until_changed: bool = False,
) -> PlanResult:
    """A plan from ``seen`` that has none of the actions ``avoided``, with whatever parameters.

    Operators of their skills need a further atom, which is true of all other objects of the skill and never changes.
    ``until_changed``: an action is permitted again once another one has changed something about one of its objects.
    What every skill is about, the one who acts, is none of these objects: it is changed by whatever is done.
    """
    permitted = {skill: _permission(skill) for skill in sorted({a.skill for a in avoided})}
    left_out = {(a.skill, a.objects) for a in avoided}
    allowed = {
        Atom(predicate, chosen)
        for skill, predicate in permitted.items()
        for chosen in groundings(skill.types, objects, distinct=False)
        if (skill, chosen) not in left_out
    }
    restricted = [(o, _restricted(o, permitted[o.skill]) if o.skill in permitted else o) for o in operators]
    made = list(restricted)
    if until_changed:
        for number, action in enumerate(avoided):
            changes = _Changes(number, action, operators)
            made += [(o, changed) for o, new in restricted for changed in changes.changing(new)]
            made += [(o, again) for o in operators for again in changes.again(o)]
            allowed |= changes.atoms
    named = [(o, replace(new, name=f"{o.name} {i}")) for i, (o, new) in enumerate(made)]
    found = planner.plan([new for _, new in named], objects, seen | allowed, goal)
    original = {new.name: o for o, new in named}
    return replace(found, plan=tuple(original[step.operator.name].ground(step.objects) for step in found.plan))


def _permission(skill: Skill) -> Predicate:
    """No name of a domain has a blank, so that no predicate is called the same."""
    return Predicate(f"may {skill.name}", skill.types, FromDomain())


def _restricted(operator: Operator, permission: Predicate) -> Operator:
    needed = LiftedAtom(permission, operator.skill_args)
    return replace(operator, preconditions=operator.preconditions | {needed})


class _Changes:
    """Operators that know whether something about an object of an action that failed has changed since."""

    def __init__(self, number: int, action: Action, operators: Sequence[Operator]) -> None:
        self._action = action
        acting = [{t for v in o.skill_args for t in v.type.lineage} for o in operators]
        self._concerned = [o for o in action.objects if not all(o.type in types for types in acting)]
        self._changed = LiftedAtom(Predicate(f"changed {number}", (), FromDomain()), ())
        self._is = {
            o: Predicate(f"is {number} {i}", ([*o.type.lineage][-1],), FromDomain())
            for i, o in enumerate(dict.fromkeys(action.objects))
        }
        self.atoms = {Atom(predicate, (o,)) for o, predicate in self._is.items()}

    def changing(self, operator: Operator) -> Iterator[Operator]:
        """The operator where it changes something about an object of the action."""
        for variable in sorted({v for a in operator.add | operator.delete for v in a.variables}):
            for o in self._concerned:
                if o.type.is_a(variable.type):
                    yield self._about(replace(operator, add=operator.add | {self._changed}), ((variable, o),))

    def again(self, operator: Operator) -> Iterator[Operator]:
        """The operator of the action, once something has changed."""
        if operator.skill == self._action.skill:
            pairs = tuple(zip(operator.skill_args, self._action.objects, strict=True))
            if all(o.type.is_a(v.type) for v, o in pairs):
                yield self._about(replace(operator, preconditions=operator.preconditions | {self._changed}), pairs)

    def _about(self, operator: Operator, pairs: Sequence[tuple[Variable, Object]]) -> Operator:
        needed = {LiftedAtom(self._is[o], (v,)) for v, o in pairs}
        return replace(operator, preconditions=operator.preconditions | needed)
