"""The robust learner's stopping rule: climb while a predicate explains planning effort (method 5.7, 6.3).

J is made of nodes, which grow with the size of a task, and of charges for plans of the wrong length, which do not grow
and which say that a predicate is missing. A candidate has to save half a back-track's charge, or nearly half of the
nodes. No threshold depends on the domain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.learning.objective.objective import Score
from pix2pred.learning.objective.planning_effort import BACKTRACK
from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.selection.chance import told_by_chance
from pix2pred.learning.selection.conditions import is_condition
from pix2pred.learning.selection.projections import is_contrary, is_projection
from pix2pred.learning.selection.stopping_rule import ScoredSet, best_explained


class ExplainedEffortSettings(BaseModel):
    """The rule's numbers; the workloads named are those of ``RobustSettings``."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    tolerance: float = Field(
        0.25, ge=0,
        description="share by which a candidate's J may exceed the smallest for it to compete, if it saves as many "
        "charges. The counts themselves vary by some 10 to 35 % with ties",
    )  # fmt: skip
    slack: float = Field(1.0, ge=0, description="nodes by which it may exceed it whatever J is: the counts' own error")
    equal_price: float = Field(
        0.01, ge=0,
        description="arguments by which prices of candidates may differ and be equal, so that J decides: two wrong "
        "labels in ten thousand, the estimate's own error where no label is wrong",
    )  # fmt: skip
    charges: float = Field(
        BACKTRACK / 2, gt=0,
        description="units of J. Charges that differ by less are equal: half of what one back-track in one "
        "demonstration is charged",
    )  # fmt: skip
    trials: int = Field(
        2, ge=0,
        description="candidates taken in advance while charges are left: two predicates may only together save a back-"
        "track (hand-empty and holding, competition workloads)",
    )  # fmt: skip
    pairs: int = Field(
        8, ge=0,
        description="candidates behind which all others are tried when those taken in advance did not pay: in Coffee "
        "only a full jug and an occupied machine together save the back-track that every demonstration is charged",
    )  # fmt: skip
    restarts: int = Field(
        3, ge=0,
        description="climbs that begin with another predicate, while charges are left at the end: a first choice that "
        "stands in for two others (a cluttered table for a thing on it and a scribble) can bar the way to both",
    )  # fmt: skip
    left: float = Field(
        0.55, gt=0, lt=1,
        description="share of J that may be left when a candidate that saves no charges is taken all the same. Chosen "
        "on 120 competition workloads, each climb continued beyond its end: needed predicates left 0.001 to"
        " 0.55 of J, what was not needed 0.66 and more with burgers, 0.14 and more in competition domains",
    )  # fmt: skip
    scepticism: float = Field(
        10.0, ge=0, description="how much more J counts per share of labels not accounted for: twice as much when one "
        "label in ten is not. Chosen on the same workloads",
    )  # fmt: skip
    doubtful: float = Field(
        0.02, ge=0, lt=1,
        description="share of its labels not accounted for, from which a chosen predicate is exchanged for another one "
        "that serves as well, J weighed by doubt: the first choice is made while others that are needed are missing, "
        "and in two demonstrations where the robot stands can tell as much as whether its hand is empty",
    )  # fmt: skip
    finer_tolerance: float = Field(
        0.01, ge=0,
        description="share by which a predicate's J, and by which its doubt, may exceed those of a coarser one that it "
        "determines, and still be taken in its place: equal but for ties. The same share of J where prices are equal",
    )  # fmt: skip
    one_for_many: float = Field(
        0.03, ge=0, lt=1,
        description="share of labels not accounted for, up to which a predicate may take the place of two or more: "
        "0.007 to 0.022 in Cleanup, where it is right, 0.056 and more in Coffee, where a hot jug is no full one",
    )  # fmt: skip
    contrary_left: float = Field(
        0.9, gt=0, lt=1,
        description="share of J that may be left when the contrary of a chosen predicate is taken as well. It says "
        "nothing new at test time, so that less has to speak for it: Juice's open lid leaves 0.78, and what is not "
        "needed 0.93 and more (competition workloads, Juice and Cleanup)",
    )  # fmt: skip
    contrary_errors: float = Field(
        0.02, ge=0, lt=0.5, description="share of states in which a predicate and its contrary may agree all the same: "
        "what repair leaves of two labels in a hundred that are wrong",
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class ExplainedEffort:
    """Climbs while a predicate explains something."""

    settings: ExplainedEffortSettings = field(default_factory=ExplainedEffortSettings)

    def finished(self, reached: Score) -> bool:
        return False

    def ceiling(self, j: float, doubt: float) -> float:
        return self._weighed(j, doubt) * (1 + self.settings.tolerance) + self.settings.slack

    def choose(self, model: OperatorModel, scored: Sequence[ScoredSet], *, trial: bool = False) -> ScoredSet:
        weighed = {s.predicate: self._weighed(s.score.total, model.doubt(s.predicate)) for s in scored}
        best = min(scored, key=lambda s: weighed[s.predicate])
        if trial:  # charges are most of J and the same for all, so that nearly all would compete
            return best
        highest = self.ceiling(best.score.total, model.doubt(best.predicate))
        rivals = [s for s in scored if weighed[s.predicate] <= highest]
        rivals = [s for s in rivals if s.score.charges <= best.score.charges + self.settings.charges]
        cheapest = self._best(model, rivals)
        finer = [s for s in rivals if self._says_more(model, s, cheapest)]
        return self._best(model, finer) if finer else cheapest

    def _best(self, model: OperatorModel, rivals: Sequence[ScoredSet]) -> ScoredSet:
        """The cheapest one; of those that cost the same the one with the smallest J, if they differ in that."""
        cheapest = min(model.price(s.predicate) for s in rivals)
        alike = [s for s in rivals if model.price(s.predicate) <= cheapest + self.settings.equal_price]
        highest = (1 + self.settings.finer_tolerance) * min(s.score.total for s in alike) + self.settings.slack
        return best_explained(model, [s for s in alike if s.score.total <= highest])

    def _says_more(self, model: OperatorModel, fine: ScoredSet, coarse: ScoredSet) -> bool:
        """Whether one predicate serves as well as another and determines it.

        Demonstrations with a single machine cannot tell "in the machine" from "in some machine". A model of the former
        makes plans that are right in either case; one of the latter takes a jug out of a machine where it is not.
        """
        tolerance = self.settings.finer_tolerance
        return (
            fine.score.total <= (1 + tolerance) * coarse.score.total + self.settings.slack
            and model.doubt(fine.predicate) <= model.doubt(coarse.predicate) + tolerance
            and is_projection(model.data, coarse.predicate, fine.predicate)
        )

    def _weighed(self, j: float, doubt: float) -> float:
        return j * (1 + self.settings.scepticism * doubt)

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        """Whether charges or nodes are saved. Demonstrations whose searches ran out of nodes before and after tell
        nothing of how many nodes there would be, and do not count."""
        if before.charges - after.charges >= self.settings.charges:
            return True
        unknown = before.exhausted & after.exhausted
        left, all_ = (score.total - sum(score.demos[d] or 0.0 for d in unknown) for score in (after, before))
        return self._weighed(left, doubt) <= self.settings.left * all_

    def hopeful(self, reached: Score, trials: int) -> bool:
        return reached.charges >= self.settings.charges and trials <= self.settings.trials

    def by_chance(self, model: OperatorModel, found: ScoredSet, before: Score, statics: int) -> bool:
        """A back-track that a predicate saves is evidence by itself; nodes are saved by whatever forbids steps."""
        return (
            not model.data.changing(found.predicate)
            and before.charges - found.score.charges < self.settings.charges
            and told_by_chance(model, found.classes, found.predicate, statics)
        )

    def firsts(self, model: OperatorModel, reached: ScoredSet, singly: Sequence[ScoredSet]) -> Sequence[ScoredSet]:
        if reached.score.charges < self.settings.charges:
            return ()
        better = [s for s in singly if s.score.total < reached.score.total]
        return sorted(better, key=lambda s: self._weighed(s.score.total, model.doubt(s.predicate)))[
            : self.settings.pairs
        ]

    def restarts(self, reached: Score) -> int:
        return self.settings.restarts if reached.charges >= self.settings.charges else 0

    def doubtful(self, model: OperatorModel, chosen: Sequence[int]) -> Sequence[int]:
        return [p for p in chosen if model.doubt(p) > self.settings.doubtful]

    def stands_for_several(self, model: OperatorModel, predicate: int) -> bool:
        return model.doubt(predicate) <= self.settings.one_for_many

    def replaces(self, model: OperatorModel, other: ScoredSet, reached: ScoredSet, doubtful: int) -> bool:
        doubts = model.doubt(other.predicate), model.doubt(doubtful)
        return (
            doubts[0] < doubts[1]
            and other.score.charges <= reached.score.charges + self.settings.charges
            and self._weighed(other.score.total, doubts[0]) < self._weighed(reached.score.total, doubts[1])
        )

    def contraries(self, model: OperatorModel, reached: ScoredSet, candidates: Sequence[int]) -> Sequence[int]:
        share = self.settings.contrary_errors
        return [p for p in candidates if any(is_contrary(model.data, p, q, share) for q in reached.chosen)]

    def negates(self, model: OperatorModel, reached: ScoredSet, other: ScoredSet) -> bool:
        """Whether J falls because one skill, whatever else it does, is never used where the predicate holds.

        A word that several skills are never used against says when in a task they come, not what they need: in Coffee
        the jug is empty whenever it is turned and whenever it is put into the machine.
        """
        if other.score.total > self.settings.contrary_left * reached.score.total:
            return False
        return sum(is_condition(model, other, skill) for skill in range(len(model.data.skills))) == 1

    @property
    def looks_back(self) -> bool:
        return True

    def as_good(self, fewer: Score, reached: Score) -> bool:
        return (
            fewer.total <= self.ceiling(reached.total, 0.0) and fewer.charges <= reached.charges + self.settings.charges
        )
