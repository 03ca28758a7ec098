"""What selection asks of a way to learn operators.

A learner is an object with its settings; ``fit`` looks at one table of labels and gives an ``OperatorModel``, which
then has operators for every subset of the predicates. A new learner is one file with these two classes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from pix2pred.learning.operators.transition_class import OperatorSchema, Partition
from pix2pred.learning.transitions import IndexedTable


class OperatorModel(Protocol):
    """Operators for any subset of the predicates of one data set. Predicates are numbers of ``data``."""

    @property
    def data(self) -> IndexedTable:
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

    def schemas(self, classes: Partition, predicates: Sequence[int]) -> list[OperatorSchema]:
        """The operators of ``classes``."""
        ...

    def price(self, candidate: int) -> float:
        """What a candidate costs, in arguments, doubts about its labels included: of two that serve alike the cheaper
        is taken."""
        ...

    def doubt(self, candidate: int) -> float:
        """Share of a candidate's labels that this learner cannot account for; 0 where it takes them at their word."""
        ...

    def unexplained(self, classes: Partition, chosen: Sequence[int]) -> float:
        """How badly the operators learned with ``chosen`` account for the labels of the last of them; less is better,
        and values of one learner alone are compared."""
        ...


class OperatorLearner(Protocol):
    """A way to learn operators, with its settings."""

    def fit(self, data: IndexedTable) -> OperatorModel:
        """Look at all labels once."""
        ...
