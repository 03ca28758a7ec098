"""Mutex groups: lifted sets of atoms of which at most one, or exactly one, holds (method 8.7; Helmert 2009).

A group is accepted when no state of the demonstrations refutes it, when every operator keeps it (whatever adds an atom
of the group deletes another one), and when the demonstrations show it at work often enough. Predicates that no operator
changes are left out: a few demonstrations cannot refute what is said about them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning.invariants.believed import BelievedDemo
from pix2pred.learning.invariants.settings import AcquaintanceSettings
from pix2pred.structs import LiftedAtom, Operator, Predicate, Type, Variable
from pix2pred.structs.knowledge import MutexGroup

Counts = NDArray[np.int64]


@dataclass(frozen=True, slots=True, order=True)
class Part:
    """Atoms of a predicate with the group's fixed object at ``position``; its other argument, if any, is counted."""

    predicate: Predicate
    position: int

    def lifted(self, fixed: Variable, number: int) -> LiftedAtom:
        """The atom with ``fixed`` at its position and a counted variable with this ``number`` elsewhere."""
        counted = (Variable(f"?c{number}", t) for t in self.predicate.types)
        return LiftedAtom(
            self.predicate, tuple(fixed if i == self.position else c for i, c in enumerate(counted))
        )  # fmt: skip


def mutex_groups(
    demos: Sequence[BelievedDemo],
    predicates: Sequence[Predicate],
    operators: Sequence[Operator],
    settings: AcquaintanceSettings,
) -> tuple[MutexGroup, ...]:
    """The groups of two atoms and more about one fixed object.

    Of nested groups the smallest is kept of which exactly one atom holds, and else the largest. A group of one atom
    would say that nothing changes it for a kind of objects, which a few demonstrations cannot refute.
    """
    changed = {a.predicate for op in operators for a in (*op.add, *op.delete)}
    dynamic = sorted(p for p in predicates if p in changed and 1 <= p.arity <= 2)
    found: list[MutexGroup] = []
    for fixed_type in sorted({t for p in dynamic for t in p.types}, key=lambda t: t.name):
        found.extend(_of_type(fixed_type, demos, dynamic, operators, settings))
    kept = [g for g in found if not any(_more_general(other, g) for other in found)]
    return tuple(sorted(kept, key=lambda g: (str(g), g.support)))


def _more_general(other: MutexGroup, group: MutexGroup) -> bool:
    """Whether ``other`` speaks about a wider kind of objects and of the same predicate.

    Where what is learned about buns differs from what holds of all items, the demonstrations merely did not show the
    rest: that a bun is picked up, or that something else is put on it.
    """
    wide, narrow = other.fixed[0].type, group.fixed[0].type
    shared = {a.predicate for a in other.atoms} & {a.predicate for a in group.atoms}
    if not shared or not narrow.is_a(wide):
        return False
    if wide != narrow:
        return True
    counted = [{v.type for a in g.atoms if a.predicate not in shared for v in a.variables} for g in (other, group)]
    return any(t != u and u.is_a(t) for t in counted[0] - {wide} for u in counted[1] - {wide})


def _of_type(
    fixed_type: Type,
    demos: Sequence[BelievedDemo],
    dynamic: Sequence[Predicate],
    operators: Sequence[Operator],
    settings: AcquaintanceSettings,
) -> Iterator[MutexGroup]:
    parts = [Part(p, i) for p in dynamic for i, t in enumerate(p.types) if fixed_type.is_a(t)]
    counts = {part: _counts(part, fixed_type, demos) for part in parts}
    where = _demo_of_instances(fixed_type, demos)
    parts = [part for part in parts if counts[part].max(initial=0) == 1]
    fitting: list[tuple[frozenset[Part], bool]] = []
    for size in range(2, settings.largest_group + 1):
        for chosen in combinations(parts, size):
            total = sum((counts[part] for part in chosen), np.zeros_like(where))
            if total.max(initial=0) > 1 or not _seen_at_work(chosen, counts, where, settings):
                continue
            if balance := _kept(chosen, fixed_type, operators):
                fitting.append((frozenset(chosen), balance.exactly and bool((total == 1).all())))
    for group, exactly in _essential(fitting):
        support = int(sum(counts[part].sum() for part in group))
        if support >= settings.least_support:
            yield _mutex_group(group, fixed_type, exactly, support)


def _essential(fitting: Sequence[tuple[frozenset[Part], bool]]) -> list[tuple[frozenset[Part], bool]]:
    """Groups of which exactly one holds and that contain no smaller one; of the others the largest."""
    exact = [g for g, exactly in fitting if exactly]
    smallest = [g for g in exact if not any(other < g for other in exact)]
    loose = [g for g, exactly in fitting if not exactly and not any(g <= e for e in smallest)]
    largest = [g for g in loose if not any(g < other for other in loose)]
    return [(g, True) for g in smallest] + [(g, False) for g in largest]


def _counts(part: Part, fixed_type: Type, demos: Sequence[BelievedDemo]) -> Counts:
    """How many atoms of ``part`` hold, for every state and object of the type."""
    rows: list[int] = []
    for demo in demos:
        things = [o for o in sorted(demo.objects) if o.type.is_a(fixed_type)]
        for state in demo.states:
            held = [a.objects[part.position] for a in state if a.predicate == part.predicate]
            rows.extend(held.count(thing) for thing in things)
    return np.array(rows, dtype=np.int64)


def _demo_of_instances(fixed_type: Type, demos: Sequence[BelievedDemo]) -> Counts:
    rows: list[int] = []
    for number, demo in enumerate(demos):
        rows.extend([number] * sum(o.type.is_a(fixed_type) for o in demo.objects) * len(demo.states))
    return np.array(rows, dtype=np.int64)


def _seen_at_work(
    chosen: Sequence[Part], counts: Mapping[Part, Counts], where: Counts, settings: AcquaintanceSettings
) -> bool:
    """Whether every part holds somewhere in enough demonstrations."""
    return all(len(set(where[counts[part] > 0].tolist())) >= settings.least_demos for part in chosen)


@dataclass(frozen=True, slots=True)
class _Balance:
    """Operators never add an atom of a group without deleting one; ``exactly``: nor the other way round."""

    exactly: bool


def _kept(chosen: Iterable[Part], fixed_type: Type, operators: Sequence[Operator]) -> _Balance | None:
    parts = set(chosen)
    exactly = True
    for operator in operators:
        for variable in operator.parameters:
            if not (variable.type.is_a(fixed_type) or fixed_type.is_a(variable.type)):
                continue
            added = _about(variable, operator.add, parts)
            deleted = _about(variable, operator.delete & operator.preconditions, parts)
            if len(added) > 1 or len(added) > len(deleted):
                return None
            exactly = exactly and len(added) == len(deleted)
    return _Balance(exactly)


def _about(variable: Variable, atoms: Iterable[LiftedAtom], parts: set[Part]) -> list[LiftedAtom]:
    return [a for a in atoms if any(a.predicate == p.predicate and a.variables[p.position] == variable for p in parts)]


def _mutex_group(group: frozenset[Part], fixed_type: Type, exactly: bool, support: int) -> MutexGroup:
    fixed = Variable("?x", fixed_type)
    atoms = frozenset(part.lifted(fixed, number) for number, part in enumerate(sorted(group)))
    return MutexGroup((fixed,), atoms, exactly, support)
