"""Hill climbing over predicate subsets (method 6.3), from the initial predicates on, one candidate at a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from pix2pred.learning.objective.objective import Map, Objective, Score
from pix2pred.learning.objective.planning_effort import DemoObjective
from pix2pred.learning.operators.learner import OperatorLearner, OperatorModel
from pix2pred.learning.operators.transition_class import to_operator
from pix2pred.learning.selection.candidates import distinct_candidates
from pix2pred.learning.selection.reconsidering import Reconsideration
from pix2pred.learning.selection.result import ClimbEnd, ClimbStep, Selection
from pix2pred.learning.selection.scored_sets import ScoredSets, SearchCounts
from pix2pred.learning.selection.stopping_rule import Reconsidering, ScoredSet, StoppingRule
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Operator, Predicate, TruthTable
from pix2pred.system.garbage import seldom_collected
from pix2pred.system.progress import Progress, silent


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


@dataclass(slots=True)
class Reached:
    """The best set of a climb, the sets with one candidate more, the steps that led there, and why it ended."""

    best: ScoredSet
    singly: Sequence[ScoredSet]
    steps: list[ClimbStep]
    end: ClimbEnd


class Climb:
    """One climb over one table. ``run`` selects; ``score`` gives J of any set."""

    def __init__(self, parts: HillClimbing, data: IndexedTable, pinned: Sequence[Predicate]) -> None:
        self._model: OperatorModel = parts.learner.fit(data)
        self._rule = parts.rule
        self._data = self._model.data
        self._pinned = tuple(sorted(self._data.predicates.index(p) for p in pinned))
        self._objective = Objective(self._model, parts.objective, parts.map_)
        representatives = distinct_candidates(self._model, self._pinned, parts.static_demos)
        effort = SearchCounts(evaluations=1, scored=1)  # the start
        self._sets = ScoredSets(self._model, self._rule, self._objective, representatives, self._pinned, effort)

    @property
    def model(self) -> OperatorModel:
        """What the learner made of the labels."""
        return self._model

    @seldom_collected()
    def run(self, progress: Progress = silent) -> Selection:
        """Climb until the rule says to stop or nothing improves J; then learn the final operators."""
        start = self._sets.set_of(self._pinned)
        self._sets.effort.budget_hits += len(start.score.exhausted)
        found = self._climb(start, self._sets, progress)
        rule = self._rule
        if isinstance(rule, Reconsidering):
            found = self._from_elsewhere(rule, start, found, progress)
        ever = list(found.best.chosen)
        if isinstance(rule, Reconsidering):
            kept = found.best.chosen
            for better, step in Reconsideration(rule, self._sets).better(found.best, found.singly, progress):
                kept = better.chosen
                found.steps += [step] if step else []
                ever += [p for p in kept if p not in ever]
        else:
            kept = self._sets.without_superseded(found.best)
        return self._finish(ever, kept, found.steps, found.end)

    def _from_elsewhere(self, rule: Reconsidering, start: ScoredSet, found: Reached, progress: Progress) -> Reached:
        """What climbs without the first choice of those before find, where it is worth more than what was found."""
        sets, first = self._sets, found
        for _ in range(rule.restarts(found.best.score)):
            added = sets.added(first.best)
            if not added:
                break
            sets = sets.without(added[0])
            first = self._climb(start, sets, progress)
            if rule.worthwhile(found.best.score, first.best.score, 0.0):
                found = first
        return found

    def _climb(self, start: ScoredSet, sets: ScoredSets, progress: Progress) -> Reached:
        """One climb from ``start`` on."""
        found = Reached(start, (), [ClimbStep(None, start.score.total, start.score.demos, ())], ClimbEnd.GOOD_ENOUGH)
        current = start
        ahead: list[ClimbStep] = []  # taken on trial: they count once a later one pays for them
        while not self._rule.finished(current.score):
            scored = sets.expand(current, progress)
            if not ahead:
                found.singly = scored
            better = [s for s in scored if s.score.exact and s.score.total < current.score.total]
            if not better:
                found.end = ClimbEnd.NOTHING_BETTER if sets.representatives else ClimbEnd.NO_CANDIDATES
                break
            best = self._rule.choose(self._model, better, trial=bool(ahead))
            ahead.append(sets.step(best, scored))
            doubt = self._model.doubt(best.predicate)
            if self._rule.worthwhile(found.best.score, best.score, doubt):
                found.best = best
                found.steps += ahead
                ahead = []
            elif not self._rule.hopeful(best.score, len(ahead)):
                pair = self._pair(found, sets, progress)
                if not pair:
                    found.end = ClimbEnd.NOTHING_WORTHWHILE
                    break
                found.steps += [step for _, step in pair]
                ahead = []
                best = found.best = pair[-1][0]
            current = best
        if found.end is ClimbEnd.GOOD_ENOUGH and len(found.steps) == 1:
            found.end = ClimbEnd.GOOD_ENOUGH_AT_ONCE if sets.representatives else ClimbEnd.NO_CANDIDATES
        return found

    def _pair(self, found: Reached, sets: ScoredSets, progress: Progress) -> Sequence[tuple[ScoredSet, ClimbStep]]:
        if not isinstance(self._rule, Reconsidering):
            return ()
        return Reconsideration(self._rule, sets).pair(found.best, found.singly, progress) or ()

    def score(self, chosen: Sequence[Predicate]) -> Score:
        """J of a given set of candidates. Raises ``ValueError`` for one that is never true, thus no candidate."""
        absent = [p.name for p in chosen if p not in self._data.predicates]
        if absent:
            raise ValueError(f"{', '.join(absent)}: never true in the demonstrations, so not a candidate")
        numbers = tuple(self._data.predicates.index(p) for p in chosen)
        classes = self._model.partition((*range(self._data.initial), *numbers))
        return self._objective.score(numbers, classes)

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
                (data.predicates[p], tuple(data.predicates[q] for q in self._sets.representatives.get(p, ())))
                for p in kept
            ),
            self._sets.effort.evaluations,
            self._sets.effort.scored,
            self._objective.searches,
            self._sets.effort.budget_hits,
            tuple(data.predicates[p] for p in self._pinned),
            end,
        )
