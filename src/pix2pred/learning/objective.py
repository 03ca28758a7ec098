"""The objective J of a predicate set: planning effort over the demonstrations, plus predicate costs (method 6.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.learning.clustering import Partition
from pix2pred.learning.data import Data, ObjectIds
from pix2pred.learning.grounded import Scene, initial_and_goal, relevant_task
from pix2pred.learning.operators import Schema, schemas
from pix2pred.learning.refinement import DemoScore, SkeletonSearch
from pix2pred.learning.settings import LearningSettings
from pix2pred.planning import Strips

W_PRED = 1e-4
"""Weight of a predicate's cost in J."""


@dataclass(frozen=True, slots=True)
class Score:
    """J of a predicate set; a lower bound when ``exact`` is False. ``demos`` holds J_d where it was computed."""

    total: float
    exact: bool
    demos: tuple[float | None, ...]
    budget_hits: int


class Objective:
    """Scores predicate sets over one data set, remembering what demonstrations with equal tasks cost."""

    def __init__(self, data: Data, settings: LearningSettings, search: SkeletonSearch) -> None:
        self._data = data
        self._settings = settings
        self._search = search
        self._scenes: dict[ObjectIds, Scene] = {}
        self._known: dict[tuple[Strips | None, int], DemoScore] = {}
        self.searches = 0

    def score(
        self, chosen: Sequence[int], classes: Partition, order: Sequence[int], bound: float = float("inf")
    ) -> Score:
        """J of the initial predicates with ``chosen``, whose transitions are partitioned into ``classes``.

        Demonstrations are summed in ``order``; once the sum exceeds ``bound`` the rest is left out (engine, item 6).
        """
        predicates = (*range(self._data.initial), *chosen)
        operators = schemas(self._data, classes, predicates, self._settings)
        total = W_PRED * sum(self._data.cost(p) for p in chosen)
        demos: list[float | None] = [None] * len(self._data.demos)
        budget_hits = 0
        exact = True
        for d in order:
            if total > bound:
                exact = False
                break
            score = self._score_demo(d, operators, predicates, bound - total)
            demos[d] = score.value
            total += score.value
            exact &= score.exact
            budget_hits += score.budget_hit
        return Score(total, exact, tuple(demos), budget_hits)

    def _score_demo(self, d: int, operators: Sequence[Schema], predicates: Sequence[int], bound: float) -> DemoScore:
        demo = self._data.demos[d]
        scene = self._scenes.get(demo.objects)
        if scene is None:
            scene = self._scenes[demo.objects] = Scene(self._data, demo.objects)
        initial, goal = initial_and_goal(self._data, scene, d, predicates)
        instances = [bits for schema in operators for bits in scene.ground(schema)]
        key = (relevant_task(instances, initial, goal), demo.states)
        known = self._known.get(key)
        if known is None or (not known.exact and known.value <= bound):
            known = self._known[key] = self._search(*key, bound)
            self.searches += 1
        return known
