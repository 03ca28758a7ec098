"""The sets of predicates that a climb looks at: scored singly, or all those with one candidate more."""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.learning.objective.objective import DemoQuery, Objective, PartialSum
from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.operators.transition_class import Partition
from pix2pred.learning.selection.result import ClimbStep, RunnerUp
from pix2pred.learning.selection.stopping_rule import Sceptical, ScoredSet, StoppingRule
from pix2pred.system.progress import Progress, Stage

BATCH = 8
"""Candidates taken to their next demonstration at a time: enough for the workers of one machine, and few enough that a
better bound is used soon. Results depend on it in ties alone, so it is fixed rather than the number of workers."""

SHOWN_RUNNERS_UP = 10
"""Other candidates that a step of the result names."""


@dataclass(slots=True)
class SearchCounts:
    """Candidate sets considered, those whose J had to be computed, and searches that ran out of nodes."""

    evaluations: int = 0
    scored: int = 0
    budget_hits: int = 0


class ScoredSets:
    """Scores sets of candidates over one table and counts what that took.

    ``representatives`` are the candidates, one of each column of labels, with those that share it. ``pinned`` ones are
    in every set.
    """

    def __init__(
        self,
        model: OperatorModel,
        rule: StoppingRule,
        objective: Objective,
        representatives: dict[int, list[int]],
        pinned: tuple[int, ...],
        effort: SearchCounts,
    ) -> None:
        self.model, self.rule, self.objective = model, rule, objective
        self.representatives, self.pinned = representatives, pinned
        self.effort = effort
        self.statics = sum(not model.data.changing(p) for p in representatives)

    def without(self, candidate: int) -> ScoredSets:
        """The same with a candidate less."""
        fewer = {p: others for p, others in self.representatives.items() if p != candidate}
        return ScoredSets(self.model, self.rule, self.objective, fewer, self.pinned, self.effort)

    def added(self, found: ScoredSet) -> Sequence[int]:
        """The members of a set that are not pinned."""
        return found.chosen[len(self.pinned) :]

    def set_of(self, chosen: Sequence[int]) -> ScoredSet:
        """A set of candidates, the last of which counts as the one that was added."""
        classes = self.model.partition((*range(self.model.data.initial), *chosen))
        return ScoredSet(chosen[-1] if chosen else -1, tuple(chosen), classes, self.objective.score(chosen, classes))

    def expand(self, current: ScoredSet, progress: Progress) -> list[ScoredSet]:
        """Score every set with one more candidate, in order of name; hopeless ones get a lower bound, and what the rule
        takes for an accident is left out.

        The sets with the smallest sums so far are taken to the next demonstration, the easiest one first, until no
        sum can compete with the best any more (method 6.5, item 6). They are taken in batches of a fixed size,
        which workers may share, so that results do not depend on the number of workers.
        """
        data = self.model.data
        order = sorted(range(len(data.demos)), key=lambda d: current.score.demos[d] or 0.0)
        candidates = [p for p in self.representatives if p not in current.chosen]
        refined = [self.model.refine(current.classes, (*range(data.initial), *current.chosen), p) for p in candidates]
        sums = [
            self.objective.begin((*current.chosen, p), classes) for p, classes in zip(candidates, refined, strict=True)
        ]
        queue = [(part.total, i, 0) for i, part in enumerate(sums)]
        heapq.heapify(queue)
        bound, accidents = current.score.total, set[int]()
        while True:
            batch: list[tuple[int, int]] = []
            while queue and queue[0][0] <= bound and len(batch) < BATCH:
                _, i, position = heapq.heappop(queue)
                if position == len(order) and self._by_chance(current, refined[i], candidates[i], sums[i]):
                    accidents.add(i)
                elif position == len(order):
                    bound = min(bound, self.rule.ceiling(sums[i].total, self.model.doubt(candidates[i])))
                else:
                    batch.append((i, position))
            if not batch:
                break
            requests = [DemoQuery(sums[i], order[position], bound - sums[i].total) for i, position in batch]
            for (i, position), score in zip(batch, self.objective.score_demos(requests), strict=True):
                sums[i].add(order[position], score)
                if sums[i].exact:
                    heapq.heappush(queue, (sums[i].total, i, position + 1))
            latest = data.predicates[candidates[batch[-1][0]]].name
            progress(Stage.SELECT, len(candidates) - len(queue), len(candidates), latest)
        progress(Stage.SELECT, len(candidates), len(candidates), "")
        self.effort.scored += len(candidates)
        self.effort.evaluations += sum(1 + len(self.representatives[p]) for p in candidates)
        self.effort.budget_hits += sum(len(part.exhausted) for part in sums)
        return [
            ScoredSet(p, (*current.chosen, p), refined[i], sums[i].score())
            for i, p in enumerate(candidates)
            if i not in accidents
        ]

    def _by_chance(self, current: ScoredSet, classes: Partition, candidate: int, found: PartialSum) -> bool:
        """Whether the rule takes what a candidate adds to a set for an accident."""
        return isinstance(self.rule, Sceptical) and self.rule.by_chance(
            self.model,
            ScoredSet(candidate, (*current.chosen, candidate), classes, found.score()),
            current.score,
            self.statics,
        )

    def step(self, best: ScoredSet, scored: Sequence[ScoredSet]) -> ClimbStep:
        """The step to ``best``; ``scored`` are the sets it was chosen from."""
        others = sorted((s for s in scored if s is not best), key=lambda s: s.score.total)[:SHOWN_RUNNERS_UP]
        names = self.model.data.predicates
        runners_up = tuple(RunnerUp(names[s.predicate], s.score.total, s.score.exact) for s in others)
        return ClimbStep(names[best.predicate], best.score.total, best.score.demos, runners_up)

    def worthwhile(self, reached: ScoredSet, scored: Sequence[ScoredSet]) -> list[ScoredSet]:
        """Those of the sets that the rule finds worth keeping after ``reached``."""
        return [
            s
            for s in scored
            if s.score.exact and self.rule.worthwhile(reached.score, s.score, self.model.doubt(s.predicate))
        ]

    def without_superseded(self, reached: ScoredSet) -> tuple[int, ...]:
        """The chosen predicates without those that later ones made superfluous, as far as the rule looks back."""
        kept = reached.chosen
        for p in self.added(reached)[:-1] if self.rule.looks_back else ():
            fewer = tuple(q for q in kept if q != p)
            if self.rule.as_good(self.set_of(fewer).score, reached.score):
                kept = fewer
        return kept
