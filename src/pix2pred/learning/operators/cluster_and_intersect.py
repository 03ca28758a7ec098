"""The published learner: equal effects, soft intersection of preconditions, rare classes dropped (method 5.1-5.5)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.learning.operators.clustering import partition, refine
from pix2pred.learning.operators.transition_class import Lifted, OperatorSchema, Partition, TransitionClass
from pix2pred.learning.transitions import IndexedTable

ROUNDING = 1e-9
"""Slack in comparing a count with a share of another: 0.8 of 5 transitions is 4, whatever the last bit says."""


@dataclass(frozen=True, slots=True)
class ClusterAndIntersect:
    """Settings of the published learner.

    An atom is a precondition where it holds in a share ``h_pre_frac`` of a class's transitions: at least that share, or
    more than it where ``strictly`` (1 then means all). A class with less than a share ``h_data_frac`` of its skill's
    transitions is dropped.
    """

    h_pre_frac: float = 0.8
    h_data_frac: float = 0.05
    strictly: bool = False

    def fit(self, data: IndexedTable) -> IntersectedOperators:
        """Operators of ``data``, whose labels are taken at their word."""
        return IntersectedOperators(data, self)

    def required_count(self, n: int) -> int:
        """In how many of ``n`` transitions an atom must hold to become a precondition (method 5.4)."""
        share = self.h_pre_frac * n
        if self.strictly and self.h_pre_frac < 1:
            return int(share + ROUNDING) + 1
        return -int(-(share - ROUNDING) // 1)


@dataclass(frozen=True, slots=True)
class IntersectedOperators:
    """The published operators of one data set."""

    data: IndexedTable
    settings: ClusterAndIntersect

    @property
    def unreliable(self) -> frozenset[int]:
        return frozenset()

    def partition(self, predicates: Sequence[int]) -> Partition:
        return partition(self.data, predicates)

    def refine(self, classes: Partition, predicates: Sequence[int], added: int) -> Partition:
        return refine(self.data, classes, predicates, added)

    def schemas(self, classes: Partition, predicates: Sequence[int]) -> list[OperatorSchema]:
        """The operators of the classes that enough transitions support; numbers keep the gaps (method 5.5)."""
        per_skill = Counter(cls.skill for cls in classes for _ in cls.members)
        return [
            OperatorSchema(number, cls, self._preconditions(cls, predicates))
            for number, cls in enumerate(classes)
            if cls.skill not in self.data.failed
            and len(cls.members) >= self.settings.h_data_frac * per_skill[cls.skill] - ROUNDING
        ]

    def price(self, candidate: int) -> float:
        return self.data.cost(candidate)

    def doubt(self, candidate: int) -> float:
        return 0.0

    def unexplained(self, classes: Partition, chosen: Sequence[int]) -> float:
        """Transitions of dropped classes and members in which a precondition over the last candidate does not hold."""
        kept = self.schemas(classes, (*range(self.data.initial), *chosen))
        count = len(self.data.transitions) - sum(len(s.cls.members) for s in kept)
        for schema in kept:
            before = schema.cls.counts_before(self.data, chosen[-1])
            count += sum(len(schema.cls.members) - before[v] for p, v in schema.pre if p == chosen[-1])
        return count

    def _preconditions(self, cls: TransitionClass, predicates: Sequence[int]) -> tuple[Lifted, ...]:
        """Atoms over the class's variables that hold beforehand in enough of its members (method 5.4)."""
        needed = max(1, self.settings.required_count(len(cls.members)))
        return tuple(
            (p, variables)
            for p in sorted(predicates)
            for variables, count in cls.counts_before(self.data, p).items()
            if count >= needed
        )
