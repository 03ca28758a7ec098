"""The objective J of a predicate set: planning effort over the demonstrations, plus predicate costs (method 6.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.learning.clustering import Partition
from pix2pred.learning.data import ObjectIds
from pix2pred.learning.grounded import Scene, initial_and_goal, relevant_task
from pix2pred.learning.learner import OperatorLearner
from pix2pred.learning.operators import Schema
from pix2pred.learning.refinement import DemoScore, SkeletonSearch
from pix2pred.planning import Strips

W_PRED = 1e-4
"""Weight of a predicate's cost in J."""


@dataclass(frozen=True, slots=True)
class Score:
    """J of a predicate set; a lower bound when ``exact`` is False. ``demos`` holds J_d where it was computed,
    ``charges`` is the part of J that is neither nodes nor the cost of predicates."""

    total: float
    charges: float
    exact: bool
    demos: tuple[float | None, ...]
    budget_hits: int


@dataclass(slots=True)
class PartialSum:
    """J of a predicate set over the demonstrations looked at so far: a lower bound, since no term is negative."""

    predicates: tuple[int, ...]
    operators: Sequence[Schema]
    total: float
    demos: list[float | None]
    charges: float = 0.0
    exact: bool = True
    budget_hits: int = 0

    def add(self, d: int, score: DemoScore) -> None:
        """Account for demonstration ``d``."""
        self.total += score.value
        self.charges += score.charges
        self.demos[d] = score.value
        self.exact &= score.exact
        self.budget_hits += score.budget_hit

    @property
    def complete(self) -> bool:
        """Whether every demonstration has been looked at, to the end."""
        return self.exact and None not in self.demos

    def score(self) -> Score:
        """The sum as it stands."""
        return Score(self.total, self.charges, self.complete, tuple(self.demos), self.budget_hits)


class Objective:
    """Scores predicate sets over one data set, remembering what demonstrations with equal tasks cost."""

    def __init__(self, learner: OperatorLearner, search: SkeletonSearch) -> None:
        self._learner = learner
        self._data = learner.data
        self._search = search
        self._scenes: dict[ObjectIds, Scene] = {}
        self._known: dict[tuple[Strips | None, int], DemoScore] = {}
        self.searches = 0

    def score(self, chosen: Sequence[int], classes: Partition) -> Score:
        """J of the initial predicates with ``chosen``, whose transitions are partitioned into ``classes``."""
        sum_ = self.begin(chosen, classes)
        for d in range(len(self._data.demos)):
            sum_.add(d, self.score_demo(sum_, d, float("inf")))
        return sum_.score()

    def begin(self, chosen: Sequence[int], classes: Partition) -> PartialSum:
        """J of a set before any demonstration is looked at: the cost of its predicates."""
        predicates = (*range(self._data.initial), *chosen)
        operators = self._learner.schemas(classes, predicates)
        cost = W_PRED * sum(self._data.cost(p) for p in chosen)
        return PartialSum(predicates, operators, cost, [None] * len(self._data.demos))

    def score_demo(self, part: PartialSum, d: int, bound: float) -> DemoScore:
        """J_d of the set that ``part`` belongs to; a lower bound once it is certain to exceed ``bound``."""
        demo = self._data.demos[d]
        scene = self._scenes.get(demo.objects)
        if scene is None:
            scene = self._scenes[demo.objects] = Scene(self._data, demo.objects)
        initial, goal = initial_and_goal(self._data, scene, d, part.predicates)
        instances = [bits for schema in part.operators for bits in scene.ground(schema)]
        key = (relevant_task(instances, initial, goal), demo.states)
        known = self._known.get(key)
        if known is None or (not known.exact and known.value <= bound):
            known = self._known[key] = self._search(*key, bound)
            self.searches += 1
        return known
