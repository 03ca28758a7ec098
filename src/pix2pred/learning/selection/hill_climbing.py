"""Hill climbing over predicate subsets (method 6.3); candidates of equal truth columns are scored once (method 6.5)."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pix2pred.learning.objective.objective import Map, Objective, Request, Score
from pix2pred.learning.objective.planning_effort import SkeletonSearch
from pix2pred.learning.operators.cluster_and_intersect import to_operator
from pix2pred.learning.operators.learner import OperatorLearner
from pix2pred.learning.selection.stopping_rules import ClimbingRule, Scored
from pix2pred.structs import Operator, Predicate

Progress = Callable[[int, int, str], None]
"""Called with (candidates done, candidates in this step, what is going on)."""


@dataclass(frozen=True, slots=True)
class RunnerUp:
    """A candidate of a step and its J, or a lower bound on it when ``exact`` is False."""

    predicate: Predicate
    j: float
    exact: bool


@dataclass(frozen=True, slots=True)
class Step:
    """One step of the climb: what was added (None at the start), the J reached, and the best other candidates."""

    added: Predicate | None
    j: float
    j_demos: tuple[float | None, ...]
    runners_up: tuple[RunnerUp, ...]


@dataclass(frozen=True, slots=True)
class Selection:
    """The result of selecting: predicates, operators learned with them, and how it came about.

    ``dropped`` were chosen but are no operator's precondition; ``pinned`` are selected because a person wants it;
    ``identical`` lists, for each selected predicate, the candidates that agree with it everywhere; ``evaluations``
    counts candidate sets considered, ``scored`` those whose J had to be computed, ``searches`` the planning searches
    this took.
    """

    selected: tuple[Predicate, ...]
    dropped: tuple[Predicate, ...]
    operators: tuple[Operator, ...]
    steps: tuple[Step, ...]
    identical: tuple[tuple[Predicate, tuple[Predicate, ...]], ...]
    evaluations: int
    scored: int
    searches: int
    budget_hits: int
    pinned: tuple[Predicate, ...] = ()


BATCH = 8
"""Candidates taken to their next demonstration at a time."""


class HillClimbing:
    """Greedy forward selection from the initial predicates and those that a person ``pinned``, which are kept."""

    def __init__(
        self,
        learner: OperatorLearner,
        search: SkeletonSearch,
        rule: ClimbingRule,
        map_: Map = map,
        pinned: Sequence[Predicate] = (),
        static_demos: int = 0,
    ) -> None:
        self._learner = learner
        self._rule = rule
        self._data = learner.data
        self._pinned = tuple(sorted(self._data.predicates.index(p) for p in pinned))
        self._static_demos = min(static_demos, len(self._data.demos))
        self._objective = Objective(learner, search, map_)
        self._representatives = self._distinct_columns()
        self._evaluations = self._scored = self._budget_hits = 0

    def run(self, progress: Progress = lambda done, total, text: None) -> Selection:
        """Climb until the early-stop rule holds or nothing improves; then learn the final operators."""
        data = self._data
        classes = self._learner.partition((*range(data.initial), *self._pinned))
        score = self._objective.score(self._pinned, classes)
        current = Scored(-1, self._pinned, classes, score)
        self._evaluations = self._scored = 1
        self._budget_hits = score.budget_hits
        steps = [Step(None, score.total, score.demos, ())]
        ahead: list[Step] = []  # taken on trial: they count once a later one pays for them
        reached = current
        while not self._rule.finished(current.score):
            scored = self._expand(current, progress)
            better = [s for s in scored if s.score.exact and s.score.total < current.score.total]
            if not better:
                break
            best = self._rule.choose(self._learner, better, trial=bool(ahead))
            ahead.append(self._step(best, scored))
            doubt = self._learner.doubt(best.predicate)
            if self._rule.worthwhile(reached.score, best.score, doubt):
                reached = best
                steps += ahead
                ahead = []
            elif not self._rule.hopeful(best.score, len(ahead)):
                break
            current = best
        return self._finish(reached.chosen, self._without_superseded(reached), steps)

    def _step(self, best: Scored, scored: Sequence[Scored]) -> Step:
        others = sorted((s for s in scored if s is not best), key=lambda s: s.score.total)[:10]
        names = self._data.predicates
        runners_up = tuple(RunnerUp(names[s.predicate], s.score.total, s.score.exact) for s in others)
        return Step(names[best.predicate], best.score.total, best.score.demos, runners_up)

    def score(self, chosen: Sequence[Predicate]) -> Score:
        """J of a given set of candidates. Raises ``ValueError`` for one that is never true, thus no candidate."""
        absent = [p.name for p in chosen if p not in self._data.predicates]
        if absent:
            raise ValueError(f"{', '.join(absent)}: never true in the demonstrations, so not a candidate")
        numbers = tuple(self._data.predicates.index(p) for p in chosen)
        classes = self._learner.partition((*range(self._data.initial), *numbers))
        return self._objective.score(numbers, classes)

    def _distinct_columns(self) -> dict[int, list[int]]:
        """The cheapest (then most reliable, then first) candidate of every truth column, with others that share it."""
        by_column: dict[tuple[object, ...], list[int]] = {}
        everything = range(self._data.initial, len(self._data.predicates))
        candidates = [p for p in everything if p in self._pinned or self._eligible(p)]
        for p in sorted(candidates, key=lambda p: (p not in self._pinned, self._learner.price(p))):
            by_column.setdefault(self._data.column(p), []).append(p)
        return {members[0]: members[1:] for members in sorted(by_column.values())}

    def _eligible(self, p: int) -> bool:
        """Whether a candidate's labels make sense, and it is more than a name for objects of one demonstration.

        A predicate that never changes can only tell objects apart. What it says of a demonstration's objects is one
        observation, however many states repeat it, so it has to do so within several demonstrations.
        """
        if p in self._learner.unreliable:
            return False
        return bool(self._data.changing(p)) or self._data.demos_divided(p) >= self._static_demos

    def _expand(self, current: Scored, progress: Progress) -> list[Scored]:
        """Score every set with one more candidate, in order of name; hopeless ones get a lower bound.

        The sets with the smallest sums so far are taken to the next demonstration, the easiest one first, until no
        sum can compete with the best any more (method 6.5, item 6). They are taken in batches of a fixed size,
        which workers may share, so that results do not depend on the number of workers.
        """
        data = self._data
        order = sorted(range(len(data.demos)), key=lambda d: current.score.demos[d] or 0.0)
        candidates = [p for p in self._representatives if p not in current.chosen]
        refined = [
            self._learner.refine(current.classes, (*range(data.initial), *current.chosen), p) for p in candidates
        ]
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
                    bound = min(bound, self._rule.ceiling(sums[i].total, self._learner.doubt(candidates[i])))
                else:
                    batch.append((i, position))
            if not batch:
                break
            requests = [Request(sums[i], order[position], bound - sums[i].total) for i, position in batch]
            for (i, position), score in zip(batch, self._objective.score_demos(requests), strict=True):
                sums[i].add(order[position], score)
                if sums[i].exact:
                    heapq.heappush(queue, (sums[i].total, i, position + 1))
            progress(len(candidates) - len(queue), len(candidates), data.predicates[candidates[batch[-1][0]]].name)
        progress(len(candidates), len(candidates), "")
        self._scored += len(candidates)
        self._evaluations += sum(1 + len(self._representatives[p]) for p in candidates)
        self._budget_hits += sum(part.budget_hits for part in sums)
        return [
            Scored(p, (*current.chosen, p), classes, part.score())
            for p, classes, part in zip(candidates, refined, sums, strict=True)
        ]

    def _without_superseded(self, reached: Scored) -> Sequence[int]:
        """The chosen predicates without those that later ones made superfluous, as far as the rule looks back."""
        kept = reached.chosen
        added = reached.chosen[len(self._pinned) :]
        for p in added[:-1] if self._rule.looks_back else ():
            fewer = tuple(q for q in kept if q != p)
            classes = self._learner.partition((*range(self._data.initial), *fewer))
            if self._rule.as_good(self._objective.score(fewer, classes), reached.score):
                kept = fewer
        return kept

    def _finish(self, chosen: Sequence[int], needed: Sequence[int], steps: Sequence[Step]) -> Selection:
        """Drop predicates that are not needed or no precondition, then learn the final operators (method 6.3)."""
        data = self._data

        def learn(numbers: Sequence[int]) -> tuple[Operator, ...]:
            predicates = (*range(data.initial), *numbers)
            found = self._learner.schemas(self._learner.partition(predicates), predicates)
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
        )
