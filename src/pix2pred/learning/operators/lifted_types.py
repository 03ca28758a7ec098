"""Operators over the types that skills are declared for, where nothing tells the types below them apart.

The published learner gives every variable the type of the objects it was seen with: a skill declared over items and
shown with a tea bag and with ice becomes two operators, and neither is about sugar. Here an argument of a skill has the
type that the skill declares, unless what the skill does tells its subtypes apart: when an effect is about a more
special type, or when classes of transitions with different effects have no type of that argument in common. Effects
that differ where a label is unknown tell nothing apart.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

from pix2pred.learning.operators.learner import OperatorLearner, OperatorModel
from pix2pred.learning.operators.transition_class import MemberCache, OperatorSchema, Partition, TransitionClass
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Type


@dataclass(frozen=True, slots=True)
class LiftedTypes:
    """Learns as ``learner`` does, with variables of declared types."""

    learner: OperatorLearner

    def fit(self, data: IndexedTable) -> LiftedOperators:
        """Look at all labels once."""
        return LiftedOperators(self.learner.fit(data.with_declared_types()))


@dataclass(slots=True)
class LiftedOperators:
    """The operators of ``model``, the variables of each narrowed where the evidence tells types apart."""

    model: OperatorModel
    _narrowed: dict[tuple[int, tuple[Type, ...]], tuple[TransitionClass, TransitionClass]] = field(default_factory=dict)

    @property
    def data(self) -> IndexedTable:
        return self.model.data

    @property
    def unreliable(self) -> frozenset[int]:
        return self.model.unreliable

    def partition(self, predicates: Sequence[int]) -> Partition:
        return self.model.partition(predicates)

    def refine(self, classes: Partition, predicates: Sequence[int], added: int) -> Partition:
        return self.model.refine(classes, predicates, added)

    def schemas(self, classes: Partition, predicates: Sequence[int]) -> list[OperatorSchema]:
        return self.model.schemas(tuple(self._narrow(classes)), predicates)

    def price(self, candidate: int) -> float:
        return self.model.price(candidate)

    def doubt(self, candidate: int) -> float:
        return self.model.doubt(candidate)

    def unexplained(self, classes: Partition, chosen: Sequence[int]) -> float:
        return self.model.unexplained(classes, chosen)

    def _narrow(self, classes: Partition) -> Iterator[TransitionClass]:
        """The classes in the same order; those that a type of an argument tells apart have the types they were seen
        with. One class with the same types is always the same object, so that what is known of it is kept."""
        seen = [_seen(self.data, cls) for cls in classes]
        for cls, kinds in zip(classes, seen, strict=True):
            others = [(other, k) for other, k in zip(classes, seen, strict=True) if other.skill == cls.skill]
            types = list(cls.types)
            for position, variable in enumerate(cls.skill_args):
                if any(
                    a[1][position].isdisjoint(b[1][position]) and self._surely_differ(a[0], b[0])
                    for a, b in combinations(others, 2)
                ):
                    types[variable] = _common(sorted(kinds[position], key=lambda t: t.name), types[variable])
            if types == list(cls.types):
                yield cls
                continue
            key = (id(cls), tuple(types))
            if key not in self._narrowed:  # which keeps ``cls`` alive, so that its id stays its own
                self._narrowed[key] = (cls, replace(cls, types=tuple(types), memo=MemberCache()))
            yield self._narrowed[key][1]

    def _surely_differ(self, one: TransitionClass, other: TransitionClass) -> bool:
        """Whether the effects differ in a predicate whose values are known around every transition of both."""
        counts = [Counter([(p, True) for p, _ in c.add] + [(p, False) for p, _ in c.delete]) for c in (one, other)]
        differing = {p for p, _ in (counts[0] - counts[1]) | (counts[1] - counts[0])}
        transitions = [self.data.transitions[m.transition] for c in (one, other) for m in c.members]
        return not differing or any(
            not any(self.data.unknown(tr.demo, t, p) for tr in transitions for t in (tr.step, tr.step + 1))
            for p in differing
        )


def _seen(data: IndexedTable, cls: TransitionClass) -> list[frozenset[Type]]:
    """The types of objects that each argument of the skill was seen with."""
    return [frozenset(data.objects[m.objects[v]].type for m in cls.members) for v in cls.skill_args]


def _common(seen: Sequence[Type], most: Type) -> Type:
    """The most special type that all types ``seen`` are, ``most`` or one below it."""
    node: Type | None = seen[0]
    while node is not None and node.name != most.name:
        if all(t.is_a(node) for t in seen):
            return node
        node = node.parent
    return most


def fitting(data: IndexedTable, cls: TransitionClass, predicate: int, effects: Sequence[tuple[int, ...]]) -> Partition:
    """``cls``, or its parts by the own types of the variables whose type is too general for an effect on ``predicate``.

    ``effects`` are the variables that the predicate's changing atoms are about.
    """
    wanted = data.predicates[predicate].types
    wide = sorted({v for atom in effects for v, t in zip(atom, wanted, strict=True) if not cls.types[v].is_a(t)})
    if not wide:
        return (cls,)
    parts: dict[tuple[Type, ...], list[int]] = {}
    for i, member in enumerate(cls.members):
        parts.setdefault(tuple(data.objects[member.objects[v]].type for v in wide), []).append(i)
    return tuple(
        replace(
            cls,
            types=tuple(dict(zip(wide, own, strict=True)).get(v, t) for v, t in enumerate(cls.types)),
            members=tuple(cls.members[i] for i in members),
            memo=MemberCache(),
        )
        for own, members in parts.items()
    )
