"""A class of transitions, which becomes an operator: what is known of its members, and its form with names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain, product

from pix2pred.learning.transitions import IndexedTable, ObjectIds
from pix2pred.structs import LiftedAtom, Operator, Type, Variable

Lifted = tuple[int, tuple[int, ...]]
"""(predicate, variable numbers)."""


@dataclass(frozen=True, slots=True)
class Member:
    """A transition of a class and the objects its variables stand for."""

    transition: int
    objects: ObjectIds


@dataclass(slots=True)
class MemberCache:
    """What follows from a class's members alone.

    The variable of each object; by predicate what ``held`` before each member, in how many (``before``) and, as a
    learner may remember, over which variables it is ``required``. What a ``whole`` of which these ``members`` are part
    knows is taken from there.
    """

    variables: list[dict[int, int]] = field(default_factory=list)
    held: dict[int, list[list[tuple[int, ...]]]] = field(default_factory=dict)
    before: dict[int, dict[tuple[int, ...], int]] = field(default_factory=dict)
    required: dict[int, list[tuple[int, ...]]] = field(default_factory=dict)
    whole: MemberCache | None = None
    members: Sequence[int] = ()

    def of(self, members: Sequence[int]) -> MemberCache:
        """The same for some of the members, the variables unchanged."""
        return MemberCache([self.variables[i] for i in members] if self.variables else [], whole=self, members=members)

    def held_before(self, predicate: int) -> list[list[tuple[int, ...]]] | None:
        """What holds before each member, if it is known."""
        if predicate not in self.held and self.whole is not None:
            known = self.whole.held_before(predicate)
            if known is not None:
                self.held[predicate] = [known[i] for i in self.members]
        return self.held.get(predicate)


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

    def variables(self) -> list[dict[int, int]]:
        """For every member, the variable that an object is bound to."""
        if not self.memo.variables:
            self.memo.variables = [{o: v for v, o in enumerate(member.objects)} for member in self.members]
        return self.memo.variables

    def counts_before(self, data: IndexedTable, predicate: int) -> dict[tuple[int, ...], int]:
        """In how many members each atom of ``predicate`` over the variables holds before the skill."""
        before = self.memo.before
        if predicate not in before:
            counts = Counter(chain.from_iterable(self.held_before(data, predicate)))
            before[predicate] = dict(sorted(counts.items()))
        return before[predicate]

    def held_before(self, data: IndexedTable, predicate: int) -> list[list[tuple[int, ...]]]:
        """For every member, the atoms of ``predicate`` over the variables that hold before the skill."""
        known = self.memo.held_before(predicate)
        if known is None:
            known = self.memo.held[predicate] = list(self._lifted_before(data, predicate))
        return known

    def _lifted_before(self, data: IndexedTable, predicate: int) -> Iterator[list[tuple[int, ...]]]:
        wanted = data.predicates[predicate].types
        atoms = list(product(*([v for v, t in enumerate(self.types) if t.is_a(w)] for w in wanted)))
        for member, variable in zip(self.members, self.variables(), strict=True):
            true = data.before(member.transition, predicate) if atoms else ()
            if len(true) > len(atoms):
                objects = member.objects
                yield [lifted for lifted in atoms if tuple([objects[v] for v in lifted]) in true]
            elif len(wanted) == 1:
                yield [(variable[o],) for (o,) in true if o in variable]
            elif len(wanted) == 2:
                yield [(variable[a], variable[b]) for a, b in true if a in variable and b in variable]
            else:
                yield [tuple([variable[o] for o in args]) for args in true if all(o in variable for o in args)]


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
