"""What hill climbing asks of a stopping rule: when to stop, and which of several good candidates to take (method 6.3).

A new rule is one file with one class.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from pix2pred.learning.objective.objective import Score
from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.operators.transition_class import Partition


@dataclass(frozen=True, slots=True)
class ScoredSet:
    """The current set with ``predicate`` added: its members in order of choice, its classes of transitions, its J."""

    predicate: int
    chosen: tuple[int, ...]
    classes: Partition
    score: Score


class StoppingRule(Protocol):
    """The decisions of a hill climb. Smaller J is better."""

    @property
    def looks_back(self) -> bool:
        """Whether sets with one predicate fewer are tried at the end, and superfluous predicates dropped."""
        ...

    def finished(self, reached: Score) -> bool:
        """Whether J is good enough to stop without looking at any candidate."""
        ...

    def ceiling(self, j: float, doubt: float) -> float:
        """The largest J with which a candidate can still be taken when another one has ``j``.

        ``doubt`` is the share of that other candidate's labels which the learner cannot account for. Candidates that
        certainly lie above are not computed to the end.
        """
        ...

    def choose(self, model: OperatorModel, scored: Sequence[ScoredSet], *, trial: bool = False) -> ScoredSet:
        """The candidate to take, out of those that improve J, which come in order of name.

        ``trial`` tells that the candidate taken before was not worthwhile by itself.
        """
        ...

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        """Whether the chosen candidate, a share ``doubt`` of whose labels is not accounted for, is to be kept."""
        ...

    def hopeful(self, reached: Score, trials: int) -> bool:
        """Whether to go on from a set whose last ``trials`` candidates have not been worthwhile together."""
        ...

    def as_good(self, fewer: Score, reached: Score) -> bool:
        """Whether a set with one predicate fewer serves as well."""
        ...


@runtime_checkable
class Reconsidering(Protocol):
    """What a rule may add: pairs that are tried when single candidates lead nowhere, and chosen predicates in whose
    place others are tried at the end."""

    def choose(self, model: OperatorModel, scored: Sequence[ScoredSet], *, trial: bool = False) -> ScoredSet:
        """As every rule does."""
        ...

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        """As every rule does."""
        ...

    def restarts(self, reached: Score) -> int:
        """How many more climbs to try, each without what those before it took first."""
        ...

    def firsts(self, model: OperatorModel, reached: ScoredSet, singly: Sequence[ScoredSet]) -> Sequence[ScoredSet]:
        """Those of the sets with one candidate more than ``reached`` behind which a second one is looked for."""
        ...

    def doubtful(self, model: OperatorModel, chosen: Sequence[int]) -> Sequence[int]:
        """Those of the chosen predicates in whose place another one is tried at the end."""
        ...

    def stands_for_several(self, model: OperatorModel, predicate: int) -> bool:
        """Whether enough of a predicate's labels are accounted for, that it may make several others superfluous."""
        ...

    def replaces(self, model: OperatorModel, other: ScoredSet, reached: ScoredSet, doubtful: int) -> bool:
        """Whether ``other``, with its last predicate in the place of ``doubtful``, is to be preferred."""
        ...

    def contraries(self, model: OperatorModel, reached: ScoredSet, candidates: Sequence[int]) -> Sequence[int]:
        """Those of the candidates that hold exactly where a chosen predicate does not."""
        ...

    def negates(self, model: OperatorModel, reached: ScoredSet, other: ScoredSet) -> bool:
        """Whether ``other``, with a contrary more than ``reached``, tells something that ``reached`` cannot."""
        ...


@runtime_checkable
class Sceptical(Protocol):
    """What a rule may add: sets that are left out, whatever their J."""

    def by_chance(self, model: OperatorModel, found: ScoredSet, before: Score, statics: int) -> bool:
        """Whether what the last candidate of ``found`` says may well be chance; ``before`` is the score without it,
        ``statics`` candidates never change."""
        ...


def best_explained(model: OperatorModel, rivals: Sequence[ScoredSet]) -> ScoredSet:
    """The cheapest of several, then the one whose labels its own operators explain best, then the first by name.

    A visual predicate costs its number of arguments; feature and quantified predicates cost more; doubt adds to it.
    """
    return min(rivals, key=lambda s: (model.price(s.predicate), model.unexplained(s.classes, s.chosen)))
