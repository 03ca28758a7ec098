"""Operators about kinds of objects that no demonstration showed: what a skill does to others, it may do to them.

A skill is declared for items, and was shown putting patties and lettuce on a board. The learned operators are about
these (method 5.2), and none is about a bun. When there is no plan with them, a bun is put there by analogy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from pix2pred.structs import (
    AbstractState,
    Atom,
    FromDomain,
    LiftedAtom,
    Object,
    Operator,
    PlanResult,
    PlanStatus,
    Predicate,
    Variable,
    groundings,
)

SUFFIX = "-by-analogy"
"""Ends the names of such operators."""

PlanWith = Callable[[Sequence[Operator], AbstractState], PlanResult]
"""Plans with certain operators from a certain state."""


def plan_by_analogy(
    plan: PlanWith, operators: Sequence[Operator], objects: Sequence[Object], seen: AbstractState
) -> PlanResult:
    """A plan in which operators may be used for other kinds of objects than they were learned from.

    Where an operator itself fits, its preconditions count: it has no analogy there. Unsolvable where there are none.
    """
    wider = analogous(operators)
    if not wider:
        return PlanResult(PlanStatus.UNSOLVABLE, (), 0, 0.0)
    guarded, unlike = [], set[Atom]()
    for old, new in wider:
        guard = Predicate(f"unlike {old.name}", new.skill.types, FromDomain())
        unlike |= {
            Atom(guard, chosen)
            for chosen in groundings(new.skill.types, objects, distinct=True)
            if not all(o.type.is_a(v.type) for o, v in zip(chosen, old.skill_args, strict=True))
        }
        guarded.append(replace(new, preconditions=new.preconditions | {LiftedAtom(guard, new.skill_args)}))
    found = plan((*operators, *guarded), seen | unlike)
    plain = {new.name: new for _, new in wider}
    steps = (plain.get(step.operator.name, step.operator).ground(step.objects) for step in found.plan)
    return replace(found, plan=tuple(steps))


def analogous(operators: Sequence[Operator]) -> Sequence[tuple[Operator, Operator]]:
    """Operators, each with what it is for objects of the types that its skill declares, where these are more general.

    Atoms that cannot be about such objects are left out: that lettuce has to be sliced before it is taken from the
    board says nothing about a bun. Of those that are then equal up to the names of variables the first stands for all.
    """
    pairs = [(old, _declared(old)) for old in operators]
    wider = [(old, new) for old, new in pairs if new.parameters != old.parameters and new.add]
    return list({_form(new): (old, new) for old, new in reversed(wider)}.values())[::-1]


def _declared(operator: Operator) -> Operator:
    declared = dict(zip(operator.skill_args, operator.skill.types, strict=True))
    own = {v: replace(v, type=declared.get(v, v.type)) for v in operator.parameters}

    def fitting(atoms: Iterable[LiftedAtom]) -> frozenset[LiftedAtom]:
        return frozenset(
            LiftedAtom(a.predicate, tuple(own[v] for v in a.variables))
            for a in atoms
            if all(own[v].type.is_a(t) for v, t in zip(a.variables, a.predicate.types, strict=True))
        )

    return replace(
        operator,
        name=f"{operator.name}{SUFFIX}",
        parameters=tuple(own[v] for v in operator.parameters),
        preconditions=fitting(operator.preconditions),
        add=fitting(operator.add),
        delete=fitting(operator.delete),
        skill_args=tuple(own[v] for v in operator.skill_args),
    )


def _form(operator: Operator) -> object:
    """Equal for operators that differ in the names of variables alone: those of the skill come first."""
    order = [*operator.skill_args, *(v for v in operator.parameters if v not in operator.skill_args)]
    name = {v: Variable(f"?x{i}", v.type) for i, v in enumerate(order)}

    def renamed(atoms: Iterable[LiftedAtom]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(a.predicate, tuple(name[v] for v in a.variables)) for a in atoms)

    effects = operator.preconditions, operator.add, operator.delete
    return operator.skill, tuple(name[v] for v in order), *(renamed(atoms) for atoms in effects)
