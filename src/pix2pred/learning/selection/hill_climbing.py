"""Hill climbing over predicate subsets (method 6.3), from the initial predicates on, one candidate at a time."""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass, field

from pix2pred.learning.objective.objective import DemoQuery, Map, Objective, Score
from pix2pred.learning.objective.planning_effort import DemoObjective
from pix2pred.learning.operators.learner import OperatorLearner, OperatorModel
from pix2pred.learning.operators.transition_class import to_operator
from pix2pred.learning.selection.candidates import distinct_candidates
from pix2pred.learning.selection.result import ClimbEnd, ClimbStep, RunnerUp, Selection
from pix2pred.learning.selection.stopping_rule import Reconsidering, ScoredSet, StoppingRule
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Operator, Predicate, TruthTable
from pix2pred.system.progress import Progress, Stage, silent

BATCH = 8
"""Candidates taken to their next demonstration at a time: enough for the workers of one machine, and few enough that a
better bound is used soon. Results depend on it in ties alone, so it is fixed rather than the number of workers."""

SHOWN_RUNNERS_UP = 10
"""Other candidates that a step of the result names."""


@dataclass(frozen=True, slots=True)
class HillClimbing:
    """Greedy forward selection, made of a way to learn operators, a way to score a demonstration, and a stopping rule.

    ``static_demos`` is the number of demonstrations within which a predicate that never changes has to tell objects
    apart; ``map_`` applies a function to many items and may share them among workers.
    """

    learner: OperatorLearner
    objective: DemoObjective
    rule: StoppingRule
    static_demos: int = 0
    map_: Map = field(default=map)

    def fit(self, table: TruthTable, pinned: Sequence[Predicate] = (), progress: Progress = silent) -> Selection:
        """Select predicates of ``table`` and learn operators with them; ``pinned`` candidates are selected anyway."""
        return self.start(IndexedTable(table), pinned).run(progress)

    def start(self, data: IndexedTable, pinned: Sequence[Predicate] = ()) -> Climb:
        """A climb that has looked at the labels but at no set of predicates yet."""
        return Climb(self, data, pinned)


class Climb:
    """One climb over one table. ``run`` selects; ``score`` gives J of any set."""

    def __init__(self, parts: HillClimbing, data: IndexedTable, pinned: Sequence[Predicate]) -> None:
        self._model: OperatorModel = parts.learner.fit(data)
        self._rule = parts.rule
        self._data = self._model.data
        self._pinned = tuple(sorted(self._data.predicates.index(p) for p in pinned))
        self._objective = Objective(self._model, parts.objective, parts.map_)
        self._representatives = distinct_candidates(self._model, self._pinned, parts.static_demos)
        self._evaluations = self._scored = self._budget_hits = 0

    @property
    def model(self) -> OperatorModel:
        """What the learner made of the labels."""
        return self._model

    def run(self, progress: Progress = silent) -> Selection:
        """Climb until the rule says to stop or nothing improves J; then learn the final operators."""
        data = self._data
        classes = self._model.partition((*range(data.initial), *self._pinned))
        score = self._objective.score(self._pinned, classes)
        current = ScoredSet(-1, self._pinned, classes, score)
        self._evaluations = self._scored = 1
        self._budget_hits = score.budget_hits
        steps = [ClimbStep(None, score.total, score.demos, ())]
        ahead: list[ClimbStep] = []  # taken on trial: they count once a later one pays for them
        reached = current
        singly: Sequence[ScoredSet] = ()
        end = ClimbEnd.GOOD_ENOUGH
        while not self._rule.finished(current.score):
            scored = self._expand(current, progress)
            if not ahead:
                singly = scored
            better = [s for s in scored if s.score.exact and s.score.total < current.score.total]
            if not better:
                end = ClimbEnd.NOTHING_BETTER if self._representatives else ClimbEnd.NO_CANDIDATES
                break
            best = self._rule.choose(self._model, better, trial=bool(ahead))
            ahead.append(self._step(best, scored))
            doubt = self._model.doubt(best.predicate)
            if self._rule.worthwhile(reached.score, best.score, doubt):
                reached = best
                steps += ahead
                ahead = []
            elif not self._rule.hopeful(best.score, len(ahead)):
                pair = self._pair(reached, singly, progress)
                if pair is None:
                    end = ClimbEnd.NOTHING_WORTHWHILE
                    break
                steps += [step for _, step in pair]
                ahead = []
                best = reached = pair[-1][0]
            current = best
        if end is ClimbEnd.GOOD_ENOUGH and len(steps) == 1:
            end = ClimbEnd.GOOD_ENOUGH_AT_ONCE if self._representatives else ClimbEnd.NO_CANDIDATES
        ever = list(reached.chosen)
        if isinstance(self._rule, Reconsidering):
            for p in self._rule.doubtful(self._model, reached.chosen[len(self._pinned) :]):
                other = self._exchanged(self._rule, reached, p, progress)
                if other is not None:
                    reached, step = other
                    steps.append(step)
                    ever.append(reached.predicate)
        return self._finish(ever, self._without_superseded(reached), steps, end)

    def _pair(
        self, reached: ScoredSet, singly: Sequence[ScoredSet], progress: Progress
    ) -> Sequence[tuple[ScoredSet, ClimbStep]] | None:
        """Two candidates that pay only together, neither of which is the best by itself, if there are any.

        Behind each promising first one all second ones are looked at; then the first is chosen again, given the second.
        """
        rule = self._rule
        if not isinstance(rule, Reconsidering):
            return None
        seconds: list[ScoredSet] = []
        for first in rule.firsts(self._model, reached, [s for s in singly if s.score.exact]):
            seconds += self._worthwhile(reached, self._expand(first, progress))
        if not seconds:
            return None
        p = min(seconds, key=lambda s: s.score.total).predicate
        second = next(s for s in singly if s.predicate == p)
        classes = self._model.partition((*range(self._data.initial), *second.chosen))
        second = ScoredSet(p, second.chosen, classes, self._objective.score(second.chosen, classes))
        scored = self._expand(second, progress)
        first = rule.choose(self._model, self._worthwhile(reached, scored))
        return (second, self._step(second, singly)), (first, self._step(first, scored))

    def _worthwhile(self, reached: ScoredSet, scored: Sequence[ScoredSet]) -> list[ScoredSet]:
        return [
            s
            for s in scored
            if s.score.exact and self._rule.worthwhile(reached.score, s.score, self._model.doubt(s.predicate))
        ]

    def _exchanged(
        self, rule: Reconsidering, reached: ScoredSet, doubtful: int, progress: Progress
    ) -> tuple[ScoredSet, ClimbStep] | None:
        """The reached set with another predicate in the place of a doubtful one, if the rule prefers it."""
        fewer = tuple(p for p in reached.chosen if p != doubtful)
        classes = self._model.partition((*range(self._data.initial), *fewer))
        current = ScoredSet(-1, fewer, classes, self._objective.score(fewer, classes))
        scored = self._expand(current, progress)
        rivals = [s for s in scored if s.score.exact and rule.replaces(self._model, s, reached, doubtful)]
        if not rivals:
            return None
        best = self._rule.choose(self._model, rivals)
        return best, self._step(best, scored)

    def _step(self, best: ScoredSet, scored: Sequence[ScoredSet]) -> ClimbStep:
        others = sorted((s for s in scored if s is not best), key=lambda s: s.score.total)[:SHOWN_RUNNERS_UP]
        names = self._data.predicates
        runners_up = tuple(RunnerUp(names[s.predicate], s.score.total, s.score.exact) for s in others)
        return ClimbStep(names[best.predicate], best.score.total, best.score.demos, runners_up)

    def score(self, chosen: Sequence[Predicate]) -> Score:
        """J of a given set of candidates. Raises ``ValueError`` for one that is never true, thus no candidate."""
        absent = [p.name for p in chosen if p not in self._data.predicates]
        if absent:
            raise ValueError(f"{', '.join(absent)}: never true in the demonstrations, so not a candidate")
        numbers = tuple(self._data.predicates.index(p) for p in chosen)
        classes = self._model.partition((*range(self._data.initial), *numbers))
        return self._objective.score(numbers, classes)

    def _expand(self, current: ScoredSet, progress: Progress) -> list[ScoredSet]:
        """Score every set with one more candidate, in order of name; hopeless ones get a lower bound.

        The sets with the smallest sums so far are taken to the next demonstration, the easiest one first, until no
        sum can compete with the best any more (method 6.5, item 6). They are taken in batches of a fixed size,
        which workers may share, so that results do not depend on the number of workers.
        """
        data = self._data
        order = sorted(range(len(data.demos)), key=lambda d: current.score.demos[d] or 0.0)
        candidates = [p for p in self._representatives if p not in current.chosen]
        refined = [self._model.refine(current.classes, (*range(data.initial), *current.chosen), p) for p in candidates]
        sums = [
            self._objective.begin((*current.chosen, p), classes) for p, classes in zip(candidates, refined, strict=True)
        ]
        queue = [(part.total, i, 0) for i, part in enumerate(sums)]
        heapq.heapify(queue)
        bound = current.score.total
        while True:
            batch: list[tuple[int, int]] = []
            while queue and queue[0][0] <= bound and len(batch) < BATCH:
                _, i, position = heapq.heappop(queue)
                if position == len(order):
                    bound = min(bound, self._rule.ceiling(sums[i].total, self._model.doubt(candidates[i])))
                else:
                    batch.append((i, position))
            if not batch:
                break
            requests = [DemoQuery(sums[i], order[position], bound - sums[i].total) for i, position in batch]
            for (i, position), score in zip(batch, self._objective.score_demos(requests), strict=True):
                sums[i].add(order[position], score)
                if sums[i].exact:
                    heapq.heappush(queue, (sums[i].total, i, position + 1))
            latest = data.predicates[candidates[batch[-1][0]]].name
            progress(Stage.SELECT, len(candidates) - len(queue), len(candidates), latest)
        progress(Stage.SELECT, len(candidates), len(candidates), "")
        self._scored += len(candidates)
        self._evaluations += sum(1 + len(self._representatives[p]) for p in candidates)
        self._budget_hits += sum(part.budget_hits for part in sums)
        return [
            ScoredSet(p, (*current.chosen, p), classes, part.score())
            for p, classes, part in zip(candidates, refined, sums, strict=True)
        ]

    def _without_superseded(self, reached: ScoredSet) -> Sequence[int]:
        """The chosen predicates without those that later ones made superfluous, as far as the rule looks back."""
        kept = reached.chosen
        added = reached.chosen[len(self._pinned) :]
        for p in added[:-1] if self._rule.looks_back else ():
            fewer = tuple(q for q in kept if q != p)
            classes = self._model.partition((*range(self._data.initial), *fewer))
            if self._rule.as_good(self._objective.score(fewer, classes), reached.score):
                kept = fewer
        return kept

    def _finish(
        self, chosen: Sequence[int], needed: Sequence[int], steps: Sequence[ClimbStep], end: ClimbEnd
    ) -> Selection:
        """Drop predicates that are not needed or no precondition, then learn the final operators (method 6.3)."""
        data = self._data

        def learn(numbers: Sequence[int]) -> tuple[Operator, ...]:
            predicates = (*range(data.initial), *numbers)
            found = self._model.schemas(self._model.partition(predicates), predicates)
            return tuple(to_operator(data, schema) for schema in found)

        used = {atom.predicate for op in learn(needed) for atom in op.preconditions}
        kept = [p for p in needed if data.predicates[p] in used or p in self._pinned]
        return Selection(
            tuple(data.predicates[p] for p in kept),
            tuple(data.predicates[p] for p in chosen if p not in kept),
            learn(kept),
            tuple(steps),
            tuple(
                (data.predicates[p], tuple(data.predicates[q] for q in self._representatives.get(p, ()))) for p in kept
            ),
            self._evaluations,
            self._scored,
            self._objective.searches,
            self._budget_hits,
            tuple(data.predicates[p] for p in self._pinned),
            end,
        )
