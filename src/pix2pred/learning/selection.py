"""Hill climbing over predicate subsets (method 6.3), with candidates of equal truth columns scored once (engine, 4)."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pix2pred.learning.clustering import Partition
from pix2pred.learning.learner import OperatorLearner
from pix2pred.learning.objective import Objective, Score
from pix2pred.learning.operators import to_operator
from pix2pred.learning.refinement import SkeletonSearch
from pix2pred.learning.settings import LearningSettings
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
    pinned: tuple[Predicate, ...]
    operators: tuple[Operator, ...]
    steps: tuple[Step, ...]
    identical: tuple[tuple[Predicate, tuple[Predicate, ...]], ...]
    evaluations: int
    scored: int
    searches: int
    budget_hits: int


@dataclass(frozen=True, slots=True)
class TieRule:
    """Which of several near-equal candidates wins: those within ``margin`` of the smallest J compete.

    ``margin`` 0 is the published rule, strict minimum, first by name.
    """

    margin: float

    def choose(self, learner: OperatorLearner, scored: Sequence[_Scored]) -> _Scored:
        """The winner: cheapest, then best explained by its own operators, then first by name.

        A visual predicate costs its number of arguments; feature and quantified predicates cost more.
        """
        smallest = min(s.score.total for s in scored)
        rivals = [s for s in scored if s.score.total <= smallest + self.margin]
        if self.margin == 0 or len(rivals) == 1:
            return rivals[0]
        return min(rivals, key=lambda s: (learner.data.cost(s.predicate), _disagreements(learner, s)))


@dataclass(frozen=True, slots=True)
class _Scored:
    """A candidate added to the current set, with the refined partition and its score."""

    predicate: int
    chosen: tuple[int, ...]
    classes: Partition
    score: Score


def _disagreements(learner: OperatorLearner, candidate: _Scored) -> int:
    """Labels that the operators learned with a candidate do not account for.

    Counts transitions of dropped classes and members in which a precondition over the candidate does not hold.
    """
    data = learner.data
    predicates = (*range(data.initial), *candidate.chosen)
    kept = learner.schemas(candidate.classes, predicates)
    count = len(data.transitions) - sum(len(s.cls.members) for s in kept)
    for schema in kept:
        before = schema.cls.counts_before(data, candidate.predicate)
        count += sum(len(schema.cls.members) - before[v] for p, v in schema.pre if p == candidate.predicate)
    return count


class HillClimbing:
    """Greedy forward selection from the initial predicates and those that a person ``pinned``, which are kept."""

    def __init__(
        self,
        learner: OperatorLearner,
        settings: LearningSettings,
        search: SkeletonSearch,
        ties: TieRule,
        pinned: Sequence[Predicate] = (),
    ) -> None:
        self._learner = learner
        self._settings = settings
        self._ties = ties
        self._data = learner.data
        self._pinned = tuple(sorted(self._data.predicates.index(p) for p in pinned))
        self._objective = Objective(learner, search)
        self._representatives = self._distinct_columns()
        self._evaluations = self._scored = self._budget_hits = 0

    def run(self, progress: Progress = lambda done, total, text: None) -> Selection:
        """Climb until the early-stop rule holds or nothing improves; then learn the final operators."""
        data = self._data
        classes = self._learner.partition((*range(data.initial), *self._pinned))
        score = self._objective.score(self._pinned, classes)
        current = _Scored(-1, self._pinned, classes, score)
        self._evaluations = self._scored = 1
        self._budget_hits = score.budget_hits
        steps = [Step(None, score.total, score.demos, ())]
        while not self._stop(current.score.total):
            scored = self._expand(current, progress)
            better = [s for s in scored if s.score.exact and s.score.total < current.score.total]
            if not better:
                break
            best = self._ties.choose(self._learner, better)
            if self._insufficient(current.score.total - best.score.total):
                break
            current = best
            others = sorted((s for s in scored if s is not best), key=lambda s: s.score.total)[:10]
            runners_up = tuple(RunnerUp(data.predicates[s.predicate], s.score.total, s.score.exact) for s in others)
            steps.append(Step(data.predicates[best.predicate], best.score.total, best.score.demos, runners_up))
        return self._finish(current.chosen, steps)

    def score(self, chosen: Sequence[Predicate]) -> Score:
        """J of a given set of candidates. Raises ``ValueError`` for one that is never true, thus no candidate."""
        absent = [p.name for p in chosen if p not in self._data.predicates]
        if absent:
            raise ValueError(f"{', '.join(absent)}: never true in the demonstrations, so not a candidate")
        numbers = tuple(self._data.predicates.index(p) for p in chosen)
        classes = self._learner.partition((*range(self._data.initial), *numbers))
        return self._objective.score(numbers, classes)

    def _stop(self, current: float) -> bool:
        return self._settings.early_stop == "level" and current <= self._settings.j_threshold

    def _insufficient(self, improvement: float) -> bool:
        """Under the improvement rule the last candidate, which buys too little, is not added (method 14.2)."""
        return self._settings.early_stop == "improvement" and improvement <= self._settings.j_threshold

    def _distinct_columns(self) -> dict[int, list[int]]:
        """The cheapest candidate (first by name) of every distinct truth column, with the others that share it."""
        by_column: dict[tuple[object, ...], list[int]] = {}
        everything = range(self._data.initial, len(self._data.predicates))
        candidates = [p for p in everything if p not in self._learner.unreliable or p in self._pinned]
        for p in sorted(candidates, key=lambda p: (p not in self._pinned, self._data.cost(p))):
            by_column.setdefault(self._data.column(p), []).append(p)
        return {members[0]: members[1:] for members in sorted(by_column.values())}

    def _expand(self, current: _Scored, progress: Progress) -> list[_Scored]:
        """Score every set with one more candidate, in order of name; hopeless ones get a lower bound.

        The set with the smallest sum so far is taken to the next demonstration, the easiest one first, until no
        sum can come within the tie margin of the best any more (engine, item 6, best-first).
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
        while queue and queue[0][0] <= bound:
            _, i, position = heapq.heappop(queue)
            progress(len(candidates) - len(queue), len(candidates), data.predicates[candidates[i]].name)
            if position == len(order):
                bound = min(bound, sums[i].total + self._ties.margin)
                continue
            d = order[position]
            sums[i].add(d, self._objective.score_demo(sums[i], d, bound - sums[i].total))
            if sums[i].exact:
                heapq.heappush(queue, (sums[i].total, i, position + 1))
        progress(len(candidates), len(candidates), "")
        self._scored += len(candidates)
        self._evaluations += sum(1 + len(self._representatives[p]) for p in candidates)
        self._budget_hits += sum(part.budget_hits for part in sums)
        return [
            _Scored(p, (*current.chosen, p), classes, part.score())
            for p, classes, part in zip(candidates, refined, sums, strict=True)
        ]

    def _finish(self, chosen: Sequence[int], steps: Sequence[Step]) -> Selection:
        """Drop predicates that are no precondition, then learn the final operators (method 6.3)."""
        data = self._data

        def learn(numbers: Sequence[int]) -> tuple[Operator, ...]:
            predicates = (*range(data.initial), *numbers)
            found = self._learner.schemas(self._learner.partition(predicates), predicates)
            return tuple(to_operator(data, schema) for schema in found)

        used = {atom.predicate for op in learn(chosen) for atom in op.preconditions}
        kept = [p for p in chosen if data.predicates[p] in used or p in self._pinned]
        return Selection(
            tuple(data.predicates[p] for p in kept),
            tuple(data.predicates[p] for p in chosen if p not in kept),
            tuple(data.predicates[p] for p in self._pinned),
            learn(kept),
            tuple(steps),
            tuple(
                (data.predicates[p], tuple(data.predicates[q] for q in self._representatives.get(p, ()))) for p in kept
            ),
            self._evaluations,
            self._scored,
            self._objective.searches,
            self._budget_hits,
        )
