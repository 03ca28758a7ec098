"""What selection asks of a way to learn operators, and the published way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from pix2pred.learning.operators.cluster_and_intersect import Schema, schemas
from pix2pred.learning.operators.clustering import Partition, partition, refine
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.transitions import Data


class OperatorLearner(Protocol):
    """Operators for any subset of the predicates of one data set."""

    @property
    def data(self) -> Data:
        """The demonstrations, with the labels this learner believes."""
        ...

    @property
    def unreliable(self) -> frozenset[int]:
        """Candidates whose labels this learner cannot make sense of; they are not to be selected."""
        ...

    def partition(self, predicates: Sequence[int]) -> Partition:
        """Classes of transitions with the same effects over ``predicates``, in order of their first member."""
        ...

    def refine(self, classes: Partition, predicates: Sequence[int], added: int) -> Partition:
        """``partition([*predicates, added])``, given ``classes``, which is the partition over ``predicates``."""
        ...

    def schemas(self, classes: Partition, predicates: Sequence[int]) -> list[Schema]:
        """The operators of ``classes``."""
        ...

    def price(self, candidate: int) -> float:
        """What a candidate costs, doubts about its labels included: the cheaper of two that serve alike is taken."""
        ...

    def doubt(self, candidate: int) -> float:
        """Share of a candidate's labels that this learner cannot account for; 0 where it takes them at their word."""
        ...

    def unexplained(self, classes: Partition, chosen: Sequence[int]) -> float:
        """How badly the operators learned with ``chosen`` account for the labels of the last of them."""
        ...


class ClusterAndIntersect:
    """The published learner: equal effects, soft intersection of preconditions, rare classes dropped (method 5)."""

    def __init__(self, data: Data, settings: LearningSettings) -> None:
        self.data = data
        self.unreliable = frozenset[int]()
        self._settings = settings

    def partition(self, predicates: Sequence[int]) -> Partition:
        return partition(self.data, predicates)

    def refine(self, classes: Partition, predicates: Sequence[int], added: int) -> Partition:
        return refine(self.data, classes, predicates, added)

    def schemas(self, classes: Partition, predicates: Sequence[int]) -> list[Schema]:
        return schemas(self.data, classes, predicates, self._settings)

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
