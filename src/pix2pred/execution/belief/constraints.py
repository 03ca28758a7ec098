"""Invariants of the objects of one task, and what they say about atoms in doubt (sum-product on their factor graph).

An invariant is believed as far as the demonstrations support it: a state that breaks it is unlikely, not impossible.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Protocol

from pix2pred.execution.belief.evidence import LARGEST, within
from pix2pred.structs import AbstractState, Atom, LiftedAtom, Object, Variable, groundings
from pix2pred.structs.knowledge import Implication, Invariant, MutexGroup

SWEEPS = 3
"""Rounds of messages; invariants of one task form short chains."""

LEAST_BROKEN = 1e-3
"""Probability of breaking an invariant, however well it is supported: what was never seen may still happen."""


class Constraint(Protocol):
    """An invariant about certain objects. Atoms are numbers here, for speed; ``members`` are those it is about."""

    @property
    def members(self) -> tuple[int, ...]:
        """The atoms it is about, in a fixed order."""
        ...

    def messages(self, odds: Sequence[float]) -> list[float]:
        """What it says about each member, as log odds, given the ``odds`` of all of them."""
        ...

    def mended(self, held: Sequence[bool], odds: Sequence[float]) -> Mapping[int, bool]:
        """The least unlikely new values of members after which it holds; none where it does, or where they are as
        unlikely as an invariant that is broken. Members whose odds are certain are never changed.
        """
        ...


@dataclass(frozen=True, slots=True)
class CountedGroup:
    """At most one of ``members`` holds, or exactly one; ``broken`` is the probability that it is not so.

    ``taken``: the one that may hold is known, and is none of the members.
    """

    members: tuple[int, ...]
    exactly: bool
    broken: float
    taken: bool = False

    def settled(self, count: int, holding: Collection[int]) -> Iterator[CountedGroup]:
        """The same of the members below ``count``, once it is known which others hold; nothing if two of them do."""
        taken = sum(a >= count and a in holding for a in self.members)
        if taken <= 1:
            yield CountedGroup(tuple(a for a in self.members if a < count), self.exactly, self.broken, taken == 1)

    def messages(self, odds: Sequence[float]) -> list[float]:
        weights = [math.exp(o) for o in odds]
        if self.taken:
            every = math.prod(1 + w for w in weights)
            return [_holding_besides(self.broken, every / (1 + w)) for w in weights]
        ones, all_ways = sum(weights), math.prod(1 + w for w in weights)
        none = self.broken if self.exactly else 1.0
        found = []
        for weight in weights:
            others, alone = all_ways / (1 + weight), ones - weight
            if_true = 1 + self.broken * (others - 1)
            if_false = none + alone + self.broken * max(0.0, others - 1 - alone)
            found.append(math.log(if_true) - math.log(if_false))
        return found

    def mended(self, held: Sequence[bool], odds: Sequence[float]) -> Mapping[int, bool]:
        by_odds = sorted(zip(odds, self.members, held, strict=True), key=lambda row: (-row[0], row[1]))
        true, room = [(o, a) for o, a, h in by_odds if h], 0 if self.taken else 1
        if len(true) > room:
            changes = {a: (o, False) for o, a in true[room:]}
        elif not true and self.exactly and not self.taken:
            changes = {a: (o, True) for o, a, _ in by_odds[:1]}
        else:
            return {}
        price = sum(abs(o) for o, _ in changes.values())
        return {a: value for a, (_, value) in changes.items()} if price <= -math.log(self.broken) else {}


def _holding_besides(broken: float, ways: float) -> float:
    """The log odds of an atom beside one that holds, the others of their group having so many ``ways`` to be."""
    return math.log(broken * ways) - math.log(1 + broken * (ways - 1))


@dataclass(frozen=True, slots=True)
class Implied:
    """The second of ``members`` holds whenever the first does; ``broken`` is the probability that it is not so."""

    members: tuple[int, int]
    broken: float

    def messages(self, odds: Sequence[float]) -> list[float]:
        premise, conclusion = math.exp(odds[0]), math.exp(odds[1])
        to_premise = math.log(conclusion + self.broken) - math.log(conclusion + 1)
        to_conclusion = math.log(premise + 1) - math.log(self.broken * premise + 1)
        return [to_premise, to_conclusion]

    def mended(self, held: Sequence[bool], odds: Sequence[float]) -> Mapping[int, bool]:
        if not held[0] or held[1]:
            return {}
        premise, conclusion = self.members
        price, change = min((abs(odds[0]), {premise: False}), (abs(odds[1]), {conclusion: True}), key=lambda p: p[0])
        return change if price <= -math.log(self.broken) else {}


class Constraints:
    """Those instances of ``invariants`` over ``objects`` that say something about the atoms ``uncertain``.

    The uncertain atoms are numbered in the given order; given atoms that occur in an instance come after them.
    """

    def __init__(self, invariants: Iterable[Invariant], objects: Sequence[Object], uncertain: Sequence[Atom]) -> None:
        self._count = len(uncertain)
        numbers = {a: i for i, a in enumerate(uncertain)}
        self._constraints: list[Constraint] = []
        for invariant in invariants:
            for atoms, made in _instances(invariant, objects):
                if any(numbers.get(a, self._count) < self._count for a in atoms):
                    self._constraints.append(made(tuple(numbers.setdefault(a, len(numbers)) for a in atoms)))
        self._given = {a: i - self._count for a, i in numbers.items() if i >= self._count}
        self._premised: dict[int, list[Constraint]] = {}
        self._groups: list[CountedGroup] = []
        self._always: list[Constraint] = []
        for constraint in self._constraints:
            self._file(constraint)
        self._holding: Sequence[int] | None = None
        self.given_are(frozenset())

    def _file(self, constraint: Constraint) -> None:
        """An implication whose given premise does not hold says nothing, and there are many of these."""
        if isinstance(constraint, Implied) and constraint.members[0] >= self._count:
            self._premised.setdefault(constraint.members[0] - self._count, []).append(constraint)
        elif isinstance(constraint, CountedGroup):
            self._groups.append(constraint)
        else:
            self._always.append(constraint)

    def given_are(self, certain: AbstractState) -> None:
        """``certain`` are the given atoms that hold from now on."""
        holding = sorted(self._given[a] for a in certain if a in self._given)
        if holding == self._holding:
            return
        self._holding = holding
        self._certain = [-LARGEST] * len(self._given)
        for number in holding:
            self._certain[number] = LARGEST
        known = {number + self._count for number in holding}
        premised = (c for number in holding for c in self._premised.get(number, ()))
        self._constraints = [
            *chain.from_iterable(g.settled(self._count, known) for g in self._groups),
            *self._always,
            *premised,
        ]

    def informed(self, odds: Sequence[float]) -> list[float]:
        """``odds`` of the uncertain atoms with what the invariants say, given the other atoms that hold."""
        total = [*odds, *self._certain]
        sent = [[0.0] * len(c.members) for c in self._constraints]
        for _ in range(SWEEPS if self._constraints else 0):
            for number, constraint in enumerate(self._constraints):
                old = sent[number]
                told = constraint.messages(
                    [within(total[a] - m, LARGEST) for a, m in zip(constraint.members, old, strict=True)]
                )
                sent[number] = [m if a < self._count else 0.0 for a, m in zip(constraint.members, told, strict=True)]
                for atom, new, before in zip(constraint.members, sent[number], old, strict=True):
                    total[atom] += new - before
        return total[: self._count]

    def consistent(self, odds: Sequence[float]) -> list[bool]:
        """The most probable values of the uncertain atoms, put right where they clash with an invariant."""
        total = [*odds, *self._certain]
        held = [o > 0 for o in total]
        for _ in range(SWEEPS):
            settled = True
            for constraint in self._constraints:
                members = constraint.members
                changes = constraint.mended([held[a] for a in members], [total[a] for a in members])
                for atom, value in changes.items():
                    if atom < self._count:
                        held[atom], settled = value, False
            if settled:
                break
        return held[: self._count]


Maker = Callable[[tuple[int, ...]], Constraint]
"""Makes the constraint about the atoms with these numbers."""


def _instances(invariant: Invariant, objects: Sequence[Object]) -> Iterator[tuple[tuple[Atom, ...], Maker]]:
    broken = max(LEAST_BROKEN, 1 / (invariant.support + 2))
    match invariant:
        case MutexGroup(fixed, lifted, exactly, _):

            def group(members: tuple[int, ...]) -> Constraint:
                return CountedGroup(members, exactly, broken)

            for chosen in groundings([v.type for v in fixed], objects, distinct=True):
                binding = dict(zip(fixed, chosen, strict=True))
                yield tuple(sorted({a for one in lifted for a in _bound(one, binding, objects)})), group
        case Implication(premise, conclusion, _):

            def implied(members: tuple[int, ...]) -> Constraint:
                return Implied((members[0], members[1]), broken)

            for chosen in groundings([v.type for v in premise.variables], objects, distinct=True):
                binding = dict(zip(premise.variables, chosen, strict=True))
                yield (premise.ground(binding), conclusion.ground(binding)), implied


def _bound(lifted: LiftedAtom, binding: Mapping[Variable, Object], objects: Sequence[Object]) -> Iterator[Atom]:
    """The atoms of ``lifted`` under ``binding``, the variables that it leaves open bound in every way."""
    free = [v for v in lifted.variables if v not in binding]
    for chosen in groundings([v.type for v in free], objects, distinct=True):
        atom = lifted.ground({**binding, **dict(zip(free, chosen, strict=True))})
        if len(set(atom.objects)) == len(atom.objects):
            yield atom
