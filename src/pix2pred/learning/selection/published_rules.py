"""The two published early stops: a threshold on J, or on what the last predicate took off it (method 6.3).

Both take the smallest J. With ``margin`` above 0 all candidates within it compete and the best explained wins;
with 0 it is the strictly smallest, first by name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.learning.objective.objective import Score
from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.selection.stopping_rule import ScoredSet, best_explained


@dataclass(frozen=True, slots=True)
class _SmallestJ:
    """What the published rules share. ``j_threshold`` and ``margin`` are in units of J, search nodes."""

    j_threshold: float
    margin: float = 0.0
    looks_back: bool = False

    def ceiling(self, j: float, doubt: float) -> float:
        """Labels are taken at their word, so doubt does not count."""
        return j + self.margin

    def choose(self, model: OperatorModel, scored: Sequence[ScoredSet], *, trial: bool = False) -> ScoredSet:
        smallest = min(s.score.total for s in scored)
        rivals = [s for s in scored if s.score.total <= self.ceiling(smallest, 0.0)]
        return rivals[0] if self.margin == 0 or len(rivals) == 1 else best_explained(model, rivals)

    def hopeful(self, reached: Score, trials: int) -> bool:
        return False


@dataclass(frozen=True, slots=True)
class LevelStop(_SmallestJ):
    """Climbs until J is at most ``j_threshold``; every improvement is kept."""

    def finished(self, reached: Score) -> bool:
        return reached.total <= self.j_threshold

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        return True

    def as_good(self, fewer: Score, reached: Score) -> bool:
        """Whether the rule would have stopped without the predicate, or it made nothing better."""
        return fewer.total <= max(reached.total, self.j_threshold)


@dataclass(frozen=True, slots=True)
class ImprovementStop(_SmallestJ):
    """Climbs while a predicate takes more than ``j_threshold`` off J; the first that does not is left out."""

    def finished(self, reached: Score) -> bool:
        return False

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        return before.total - after.total > self.j_threshold

    def as_good(self, fewer: Score, reached: Score) -> bool:
        """Whether the rule would have left the predicate out."""
        return fewer.total - reached.total <= self.j_threshold
