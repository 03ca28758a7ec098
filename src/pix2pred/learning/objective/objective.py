"""The objective J of a predicate set: planning effort over the demonstrations, plus predicate costs (method 6.1)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from pix2pred.learning.objective.demo_tasks import DemoTasks, SetTasks
from pix2pred.learning.objective.planning_effort import UPPER_BOUND, DemoObjective, DemoScore
from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.operators.transition_class import Partition
from pix2pred.planning import GroundingBudgetError, Strips

W_PRED = 1e-4
"""Weight of a predicate's cost in J."""


@dataclass(frozen=True, slots=True)
class Score:
    """J of a predicate set; a lower bound when ``exact`` is False. ``demos`` holds J_d where it was computed,
    ``charges`` is the part of J that is neither nodes nor the cost of predicates, ``exhausted`` are the demonstrations
    whose search ran out of nodes."""

    total: float
    charges: float
    exact: bool
    demos: tuple[float | None, ...]
    exhausted: frozenset[int] = frozenset()


@dataclass(slots=True)
class PartialSum:
    """J of a predicate set over the demonstrations looked at so far: a lower bound, since no term is negative."""

    tasks: SetTasks
    total: float
    demos: list[float | None]
    charges: float = 0.0
    exact: bool = True
    exhausted: set[int] = field(default_factory=set)

    def add(self, d: int, score: DemoScore) -> None:
        """Account for demonstration ``d``."""
        self.total += score.value
        self.charges += score.charges
        self.demos[d] = score.value
        self.exact &= score.exact
        if score.budget_hit:
            self.exhausted.add(d)

    @property
    def complete(self) -> bool:
        """Whether every demonstration has been looked at, to the end."""
        return self.exact and None not in self.demos

    def score(self) -> Score:
        """The sum as it stands."""
        return Score(self.total, self.charges, self.complete, tuple(self.demos), frozenset(self.exhausted))


TaskKey = tuple[Strips | None, int]
"""A demonstration's task and its number of states: all that J_d depends on."""

Map = Callable[[Callable[..., DemoScore], Sequence[Any]], Iterable[DemoScore]]
"""Applies a function to every item, in order: ``map``, or the same by many workers."""

OVERSIZED = DemoScore(UPPER_BOUND, budget_hit=True)
"""What a demonstration costs whose task has too many ground operators."""


@dataclass(frozen=True, slots=True)
class DemoQuery:
    """J_d of the set that ``part`` belongs to, or a lower bound on it that exceeds ``bound``."""

    part: PartialSum
    d: int
    bound: float


class Objective:
    """Scores predicate sets over one data set, remembering what demonstrations with equal tasks cost."""

    def __init__(self, model: OperatorModel, of_demo: DemoObjective, map_: Map = map) -> None:
        self._model = model
        self._data = model.data
        self._of_demo = of_demo
        self._map = map_
        self._tasks = DemoTasks(model.data)
        self._known: dict[TaskKey, DemoScore] = {}
        self.searches = 0

    def score(self, chosen: Sequence[int], classes: Partition) -> Score:
        """J of the initial predicates with ``chosen``, whose transitions are partitioned into ``classes``."""
        sum_ = self.begin(chosen, classes)
        demos = range(len(self._data.demos))
        for d, score in zip(demos, self.score_demos([DemoQuery(sum_, d, float("inf")) for d in demos]), strict=True):
            sum_.add(d, score)
        return sum_.score()

    def begin(self, chosen: Sequence[int], classes: Partition) -> PartialSum:
        """J of a set before any demonstration is looked at: the cost of its predicates."""
        predicates = (*range(self._data.initial), *chosen)
        operators = self._model.schemas(classes, predicates)
        cost = W_PRED * sum(self._data.cost(p) for p in chosen)
        return PartialSum(SetTasks(operators, predicates), cost, [None] * len(self._data.demos))

    def score_demos(self, requests: Sequence[DemoQuery]) -> list[DemoScore]:
        """J_d for every request. Searches that are the same are made once, for the largest bound."""
        keys = [self._key(r.part, r.d) for r in requests]
        wanted: dict[TaskKey, float] = {}
        for key, request in zip(keys, requests, strict=True):
            known = self._known.get(key) if key else OVERSIZED
            if key and (known is None or (not known.exact and known.value <= request.bound)):
                wanted[key] = max(request.bound, wanted.get(key, 0.0))
        searches = [(self._of_demo, *key, bound) for key, bound in wanted.items()]
        self._known.update(zip(wanted, self._map(_search, searches), strict=True))
        self.searches += len(searches)
        return [self._known[key] if key else OVERSIZED for key in keys]

    def _key(self, part: PartialSum, d: int) -> TaskKey | None:
        """What J_d depends on; ``None`` when the task is too large to write down."""
        try:
            task = self._tasks.task(part.tasks, d)
        except GroundingBudgetError:
            return None
        demo = self._data.demos[d]
        return task, demo.states - demo.failed


def _search(request: tuple[DemoObjective, Strips | None, int, float]) -> DemoScore:
    search, task, states, bound = request
    return search(task, states, bound)
