"""When hill climbing stops, and which of several good candidates it takes (method 6.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from pix2pred.learning.objective.objective import Score
from pix2pred.learning.objective.planning_effort import BACKTRACK
from pix2pred.learning.operators.clustering import Partition
from pix2pred.learning.operators.learner import OperatorLearner
from pix2pred.learning.selection.projections import is_projection


@dataclass(frozen=True, slots=True)
class Scored:
    """A candidate added to the current set, with the refined partition and its score."""

    predicate: int
    chosen: tuple[int, ...]
    classes: Partition
    score: Score


class ClimbingRule(Protocol):
    """The decisions of a hill climb. With ``looks_back``, predicates that later ones made superfluous are dropped."""

    @property
    def looks_back(self) -> bool:
        """Whether sets with one predicate fewer are tried at the end."""
        ...

    def finished(self, reached: Score) -> bool:
        """Whether nothing is left to gain."""
        ...

    def ceiling(self, j: float, doubt: float) -> float:
        """The largest J with which a candidate can still be taken when another, of which ``doubt`` is the share of
        labels not accounted for, has ``j``."""
        ...

    def choose(self, learner: OperatorLearner, scored: Sequence[Scored], *, trial: bool = False) -> Scored:
        """The candidate to take, out of those that improve J, which come in order of name. ``trial``: the one before
        was not worthwhile by itself."""
        ...

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        """Whether the chosen candidate, of which ``doubt`` is not accounted for, buys enough to be taken."""
        ...

    def hopeful(self, reached: Score, trials: int) -> bool:
        """Whether to go on from a set whose last ``trials`` candidates have not been worthwhile together."""
        ...

    def as_good(self, fewer: Score, reached: Score) -> bool:
        """Whether a set with one predicate fewer serves as well."""
        ...


def best_explained(learner: OperatorLearner, rivals: Sequence[Scored]) -> Scored:
    """The cheapest, then the one whose labels its own operators explain best, then the first by name.

    A visual predicate costs its number of arguments; feature and quantified predicates cost more; doubt adds to it.
    """
    return min(rivals, key=lambda s: (learner.price(s.predicate), learner.unexplained(s.classes, s.chosen)))


@dataclass(frozen=True, slots=True)
class Published:
    """The published rules: a threshold on J or on its last improvement, and the strictly smallest J, first by name.

    With ``margin`` above 0 all candidates within it compete, and the best explained wins (method 6.3, ties).
    """

    early_stop: Literal["level", "improvement"]
    j_threshold: float
    margin: float = 0.0
    looks_back: bool = False

    def finished(self, reached: Score) -> bool:
        return self.early_stop == "level" and reached.total <= self.j_threshold

    def ceiling(self, j: float, doubt: float) -> float:
        """Labels are taken at their word."""
        return j + self.margin

    def choose(self, learner: OperatorLearner, scored: Sequence[Scored], *, trial: bool = False) -> Scored:
        smallest = min(s.score.total for s in scored)
        rivals = [s for s in scored if s.score.total <= self.ceiling(smallest, 0.0)]
        return rivals[0] if self.margin == 0 or len(rivals) == 1 else best_explained(learner, rivals)

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        """Under the improvement rule the last candidate, which buys too little, is not added
        (method 12.2)."""
        return self.early_stop == "level" or before.total - after.total > self.j_threshold

    def hopeful(self, reached: Score, trials: int) -> bool:
        return False

    def as_good(self, fewer: Score, reached: Score) -> bool:
        """Whether the early stop would not have asked for the predicate."""
        if self.early_stop == "improvement":
            return fewer.total - reached.total <= self.j_threshold
        return fewer.total <= max(reached.total, self.j_threshold)


@dataclass(frozen=True, slots=True)
class Explained:
    """Climb while a predicate explains something: nothing to tune.

    J is made of nodes, which grow with the size of a task, and of charges for plans of the wrong length, which do not
    and which say that a predicate is missing. A candidate has to save half a back-track, or nearly half of the nodes.
    """

    tolerance: float = 0.25
    """Candidates whose J is at most this much larger than the smallest compete if they save as many charges."""

    trials: int = 2
    """Candidates taken in advance while charges are left: two predicates may only together save a back-track."""

    drop: float = 0.55
    """What is left of J when a candidate that saves no charges is taken all the same."""

    scepticism: float = 10.0
    """How much more J counts per share of labels not accounted for: twice as much when one label in ten is not."""

    def finished(self, reached: Score) -> bool:
        return False

    def ceiling(self, j: float, doubt: float) -> float:
        return self._weighed(j, doubt) * (1 + self.tolerance) + 1

    def choose(self, learner: OperatorLearner, scored: Sequence[Scored], *, trial: bool = False) -> Scored:
        weighed = {s.predicate: self._weighed(s.score.total, learner.doubt(s.predicate)) for s in scored}
        best = min(scored, key=lambda s: weighed[s.predicate])
        if trial:  # charges are most of J and the same for all, so that nearly all would compete
            return best
        highest = self.ceiling(best.score.total, learner.doubt(best.predicate))
        rivals = [s for s in scored if weighed[s.predicate] <= highest]
        rivals = [s for s in rivals if s.score.charges <= best.score.charges + BACKTRACK / 2]
        cheapest = best_explained(learner, rivals)
        finer = [s for s in rivals if self._says_more(learner, s, cheapest)]
        return best_explained(learner, finer) if finer else cheapest

    def _says_more(self, learner: OperatorLearner, fine: Scored, coarse: Scored) -> bool:
        """Whether one predicate serves as well as another and determines it.

        Demonstrations with a single machine cannot tell "in the machine" from "in some machine". A model of the former
        makes plans that are right in either case; one of the latter takes a jug out of a machine where it is not.
        """
        return (
            fine.score.total <= 1.01 * coarse.score.total + 1
            and learner.doubt(fine.predicate) <= learner.doubt(coarse.predicate) + 0.01
            and is_projection(learner.data, coarse.predicate, fine.predicate)
        )

    def _weighed(self, j: float, doubt: float) -> float:
        return j * (1 + self.scepticism * doubt)

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        saved = before.charges - after.charges
        return saved >= BACKTRACK / 2 or self._weighed(after.total, doubt) <= self.drop * before.total

    def hopeful(self, reached: Score, trials: int) -> bool:
        return reached.charges >= BACKTRACK / 2 and trials <= self.trials

    @property
    def looks_back(self) -> bool:
        return True

    def as_good(self, fewer: Score, reached: Score) -> bool:
        return fewer.total <= self.ceiling(reached.total, 0.0) and fewer.charges <= reached.charges + BACKTRACK / 2
