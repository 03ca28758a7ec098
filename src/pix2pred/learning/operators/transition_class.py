"""A class of transitions, which becomes an operator: what is known of its members, and its form with names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple

from pix2pred.learning.transitions import IndexedTable, ObjectIds
from pix2pred.structs import LiftedAtom, Operator, Type, Variable

Lifted = tuple[int, tuple[int, ...]]
"""(predicate, variable numbers)."""


class Member(NamedTuple):
    """A transition of a class and the objects its variables stand for."""

    transition: int
    objects: ObjectIds


Held = dict[tuple[int, ...], int]
"""Atoms of a predicate over a class's variables, in order, with the transitions before which they hold as bits."""


@dataclass(slots=True)
class MemberCache:
    """What follows from a class's members alone.

    The variable of each object; by variables what they are ``bound`` to in which transitions; by predicate what
    ``held`` before which of them, before how many (``before``) and, as a learner may remember, over which variables it
    is ``required``. A part of a class takes from its ``origin`` what it can.
    """

    variables: list[dict[int, int]] = field(default_factory=list)
    bound: dict[tuple[int, ...], dict[ObjectIds, int]] = field(default_factory=dict)
    held: dict[int, Held] = field(default_factory=dict)
    before: dict[int, dict[tuple[int, ...], int]] = field(default_factory=dict)
    required: dict[int, list[tuple[int, ...]]] = field(default_factory=dict)
    origin: Origin | None = None


@dataclass(frozen=True, slots=True)
class Origin:
    """The class that a part was split from: which of its ``members`` the part has, which transitions these are, as
    bits, and which number its variables have in the part, ``None`` where they kept theirs."""

    whole: TransitionClass
    members: Sequence[int]
    bits: int
    renumbered: tuple[int, ...] | None


@dataclass(frozen=True, slots=True, eq=False)
class TransitionClass:
    """Transitions of one skill with the same effects up to renaming; variable i has type ``types[i]``."""

    skill: int
    types: tuple[Type, ...]
    skill_args: tuple[int, ...]
    add: tuple[Lifted, ...]
    delete: tuple[Lifted, ...]
    members: tuple[Member, ...]
    memo: MemberCache = field(default_factory=MemberCache)

    @property
    def first(self) -> int:
        """The first transition: classes are ordered by it."""
        return self.members[0].transition

    def part(self, members: Sequence[int], order: Sequence[int]) -> MemberCache:
        """What the class of some members alone, by their numbers, takes over; ``order`` lists this class's variables
        in the order that they have there."""
        new = None if all(v == i for i, v in enumerate(order)) else tuple(map(order.index, range(len(order))))
        whole, origin = self, self.memo.origin
        if origin is not None:
            whole, members = origin.whole, [origin.members[i] for i in members]
            if origin.renumbered is not None:
                new = tuple([v if new is None else new[v] for v in origin.renumbered])
        bits = sum([1 << whole.members[i].transition for i in members])
        return MemberCache(origin=Origin(whole, members, bits, new))

    def variables(self) -> list[dict[int, int]]:
        """For every member, the variable that an object is bound to."""
        if not self.memo.variables:
            origin = self.memo.origin
            if origin is None or origin.renumbered is not None:
                self.memo.variables = [{o: v for v, o in enumerate(member.objects)} for member in self.members]
            else:
                known = origin.whole.variables()
                self.memo.variables = [known[i] for i in origin.members]
        return self.memo.variables

    def counts_before(self, data: IndexedTable, predicate: int) -> dict[tuple[int, ...], int]:
        """In how many members each atom of ``predicate`` over the variables holds before the skill."""
        before = self.memo.before
        if predicate not in before:
            origin = self.memo.origin
            if origin is None:
                counts = {v: held.bit_count() for v, held in self._held_before(data, predicate).items()}
            else:
                whole = origin.whole._held_before(data, predicate)
                counts = {v: n for v, held in whole.items() if (n := (held & origin.bits).bit_count())}
                if (new := origin.renumbered) is not None:
                    counts = dict(sorted([(tuple([new[x] for x in v]), n) for v, n in counts.items()]))
            before[predicate] = counts
        return before[predicate]

    def _held_before(self, data: IndexedTable, predicate: int) -> Held:
        """The atoms of ``predicate`` over the variables that hold before the skill, and in which transitions."""
        known = self.memo.held.get(predicate)
        if known is None:
            held, known = data.held_before(predicate), {}
            wanted = data.predicates[predicate].types
            for atom in product(*([v for v, t in enumerate(self.types) if t.is_a(w)] for w in wanted)):
                found = 0
                for objects, transitions in self._bound(atom).items():
                    if objects in held:
                        found |= held[objects] & transitions
                if found:
                    known[atom] = found
            self.memo.held[predicate] = known
        return known

    def _bound(self, variables: tuple[int, ...]) -> dict[ObjectIds, int]:
        """What ``variables`` stand for, and in which transitions, as bits."""
        known = self.memo.bound.get(variables)
        if known is None:
            known = {}
            for transition, objects in self.members:
                own = tuple([objects[v] for v in variables])
                known[own] = known.get(own, 0) | 1 << transition
            self.memo.bound[variables] = known
        return known


Partition = tuple[TransitionClass, ...]
"""Classes ordered by first transition; class i becomes operator ``Op<i>``."""


@dataclass(frozen=True, slots=True)
class OperatorSchema:
    """An operator in numbers: its class, its number in ``Op<number>``, and its preconditions."""

    number: int
    cls: TransitionClass
    pre: tuple[Lifted, ...]


def to_operator(data: IndexedTable, schema: OperatorSchema) -> Operator:
    """The operator with names: variables ``?x0, ?x1, ...`` in the order of the first member's object names."""
    cls = schema.cls
    variables = tuple(Variable(f"?x{i}", t) for i, t in enumerate(cls.types))

    def atoms(lifted: Sequence[Lifted]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(data.predicates[p], tuple(variables[v] for v in args)) for p, args in lifted)

    return Operator(
        f"Op{schema.number}",
        variables,
        atoms(schema.pre),
        atoms(cls.add),
        atoms(cls.delete),
        data.skills[cls.skill],
        tuple(variables[v] for v in cls.skill_args),
        len(cls.members),
    )
