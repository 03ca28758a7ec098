"""Implications: an atom that holds whenever another one does, as far as demonstrations and operators tell.

Accepted is what no state of the demonstrations refutes and every operator keeps: what adds the premise needs or adds
the conclusion, and what deletes the conclusion deletes the premise, or needs something that excludes it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations

from pix2pred.learning.invariants.believed import BelievedDemo
from pix2pred.learning.invariants.settings import AcquaintanceSettings
from pix2pred.structs import LiftedAtom, Operator, Predicate, Variable, groundings
from pix2pred.structs.knowledge import Implication, MutexGroup


def implications(
    demos: Sequence[BelievedDemo],
    predicates: Sequence[Predicate],
    operators: Sequence[Operator],
    groups: Sequence[MutexGroup],
    settings: AcquaintanceSettings,
) -> tuple[Implication, ...]:
    """All implications between two dynamic predicates whose conclusion is about objects of the premise."""
    changed = {a.predicate for op in operators for a in (*op.add, *op.delete)}
    dynamic = sorted(p for p in predicates if p in changed)
    found = []
    for premise_of in dynamic:
        for conclusion_of in dynamic:
            for premise, conclusion in _pairs(premise_of, conclusion_of):
                support = _support(premise, conclusion, demos, settings)
                if support and _kept(premise, conclusion, operators, groups):
                    found.append(Implication(premise, conclusion, support))
    return tuple(found)


def _pairs(premise: Predicate, conclusion: Predicate) -> Iterator[tuple[LiftedAtom, LiftedAtom]]:
    """The premise over variables of its own types, and the conclusion over some of these in every fitting order."""
    variables = tuple(Variable(f"?x{i}", t) for i, t in enumerate(premise.types))
    if not conclusion.types:
        return
    for chosen in permutations(variables, conclusion.arity):
        fits = all(v.type.is_a(t) for v, t in zip(chosen, conclusion.types, strict=True))
        if fits and (premise != conclusion or chosen != variables):
            yield LiftedAtom(premise, variables), LiftedAtom(conclusion, chosen)


def _support(
    premise: LiftedAtom, conclusion: LiftedAtom, demos: Sequence[BelievedDemo], settings: AcquaintanceSettings
) -> int:
    """Instances in which both hold; 0 when one is refuted, when they are too few, or when the conclusion never fails.

    What always holds of everything is implied by anything, and so says nothing about the premise.
    """
    support, where, fails = 0, set[int](), False
    for number, demo in enumerate(demos):
        possible = [
            premise.predicate(*objects) for objects in groundings(premise.predicate.types, demo.objects, distinct=True)
        ]
        for state in demo.states:
            for atom in possible:
                binding = dict(zip(premise.variables, atom.objects, strict=True))
                concluded = conclusion.ground(binding) in state
                fails |= not concluded
                if atom in state:
                    if not concluded:
                        return 0
                    support += 1
                    where.add(number)
    enough = support >= settings.least_support and len(where) >= settings.least_demos
    return support if enough and fails else 0


def _kept(
    premise: LiftedAtom, conclusion: LiftedAtom, operators: Sequence[Operator], groups: Sequence[MutexGroup]
) -> bool:
    for operator in operators:
        remaining = (operator.preconditions - operator.delete) | operator.add
        for atom in operator.add:
            if atom.predicate == premise.predicate:
                binding = dict(zip(premise.variables, atom.variables, strict=True))
                if _bound(conclusion, binding) not in remaining:
                    return False
        for atom in operator.delete:
            if atom.predicate == conclusion.predicate and not _premise_gone(
                premise, conclusion, atom, operator, groups
            ):
                return False
    return True


def _bound(atom: LiftedAtom, binding: Mapping[Variable, Variable]) -> LiftedAtom:
    return LiftedAtom(atom.predicate, tuple(binding[v] for v in atom.variables))


def _premise_gone(
    premise: LiftedAtom, conclusion: LiftedAtom, deleted: LiftedAtom, operator: Operator, groups: Sequence[MutexGroup]
) -> bool:
    """Whether no instance of ``premise`` can hold after ``operator`` has deleted its conclusion ``deleted``."""
    binding = dict(zip(conclusion.variables, deleted.variables, strict=True))
    matching = [
        a
        for a in operator.delete
        if a.predicate == premise.predicate
        and all(binding.get(v, o) == o for v, o in zip(premise.variables, a.variables, strict=True))
    ]
    if matching and set(premise.variables) <= set(conclusion.variables):
        return True
    return any(_excludes(group, premise, binding, operator, matching) for group in groups)


def _excludes(
    group: MutexGroup,
    premise: LiftedAtom,
    binding: Mapping[Variable, Variable],
    operator: Operator,
    deleted: Sequence[LiftedAtom],
) -> bool:
    """Whether ``group`` lets at most one instance hold and the operator needs, and deletes or replaces, that one."""
    for member in group.atoms:
        if member.predicate != premise.predicate:
            continue
        position = member.variables.index(group.fixed[0])
        about = binding.get(premise.variables[position])
        if about is None:
            continue
        needed = [
            a
            for a in operator.preconditions
            for other in group.atoms
            if a.predicate == other.predicate and a.variables[other.variables.index(group.fixed[0])] == about
        ]
        added = [a for a in operator.add if a.predicate == premise.predicate and a.variables[position] == about]
        kept = [a for a in needed if a.predicate == premise.predicate and a not in deleted]
        if needed and not added and not kept:
            return True
    return False
