"""A learner, an objective and a stopping rule from outside the package: objects passed in, nothing registered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from learning.random_tables import BALL, candidate, demo, given, table
from pix2pred.learning import HillClimbing, Selection
from pix2pred.learning.objective.objective import Score
from pix2pred.learning.objective.planning_effort import DemoObjective, DemoScore
from pix2pred.learning.operators.clustering import partition, refine
from pix2pred.learning.operators.learner import OperatorLearner, OperatorModel
from pix2pred.learning.operators.transition_class import OperatorSchema, Partition
from pix2pred.learning.selection.stopping_rule import ScoredSet, StoppingRule
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.strategies import demo_objective, operator_learner, stopping_rule
from pix2pred.learning.transitions import IndexedTable
from pix2pred.planning import LMCut, Strips
from pix2pred.structs import Action, Object, Skill, TruthTable

PUBLISHED = LearningSettings(operators="cluster-and-intersect", j_threshold=0)


@dataclass(frozen=True)
class Unanimous:
    """A learner: what holds before every transition of a class is its precondition, and no class is dropped."""

    def fit(self, data: IndexedTable) -> OperatorModel:
        return UnanimousOperators(data)


@dataclass(frozen=True)
class UnanimousOperators:
    data: IndexedTable
    unreliable: frozenset[int] = frozenset()

    def partition(self, predicates: Sequence[int]) -> Partition:
        return partition(self.data, predicates)

    def refine(self, classes: Partition, predicates: Sequence[int], added: int) -> Partition:
        return refine(self.data, classes, predicates, added)

    def schemas(self, classes: Partition, predicates: Sequence[int]) -> list[OperatorSchema]:
        return [
            OperatorSchema(number, cls, tuple(
                (p, variables)
                for p in sorted(predicates)
                for variables, count in cls.counts_before(self.data, p).items()
                if count == len(cls.members)
            ))
            for number, cls in enumerate(classes)
        ]  # fmt: skip

    def price(self, candidate: int) -> float:
        return self.data.cost(candidate)

    def doubt(self, candidate: int) -> float:
        return 0.0

    def unexplained(self, classes: Partition, chosen: Sequence[int]) -> float:
        return 0.0


@dataclass(frozen=True)
class TooShort:
    """An objective: how many steps the landmark estimate of a demonstration is shorter than the demonstration."""

    near_tie: float = 0.0

    def __call__(self, task: Strips | None, states: int, bound: float) -> DemoScore:
        estimate = None if task is None else LMCut(task)(task.initial)
        return DemoScore(1000.0 if estimate is None else float(abs(states - 1 - estimate)))


@dataclass(frozen=True)
class Share:
    """A stopping rule: a predicate has to take off a share of J."""

    share: float
    looks_back: bool = False

    def finished(self, reached: Score) -> bool:
        return False

    def ceiling(self, j: float, doubt: float) -> float:
        return j

    def choose(self, model: OperatorModel, scored: Sequence[ScoredSet], *, trial: bool = False) -> ScoredSet:
        return min(scored, key=lambda s: s.score.total)

    def worthwhile(self, before: Score, after: Score, doubt: float) -> bool:
        return after.total <= (1 - self.share) * before.total

    def hopeful(self, reached: Score, trials: int) -> bool:
        return False

    def as_good(self, fewer: Score, reached: Score) -> bool:
        return False


HOT, WASHED, SERVED = candidate("hot", BALL), candidate("washed", BALL), given("Served", BALL)
HEAT, WASH, SERVE = (Skill(n, (BALL,)) for n in ("Heat", "Wash", "Serve"))
A = Object("a", BALL)


def kitchen(cold: int = 0) -> TruthTable:
    """Heat, wash, serve, five times; what is washed and served in the first ``cold`` demonstrations was not hot."""
    demos = []
    for i in range(5):
        hot, washed = [0, 1, 1, 1] if i >= cold else [0] * 4, [0, 0, 1, 1]
        states = [[HOT(A)] * hot[t] + [WASHED(A)] * washed[t] + [SERVED(A)] * (t == 3) for t in range(4)]
        demos.append(demo(f"d{i}", [A], [Action(s, (A,)) for s in (HEAT, WASH, SERVE)], states, [SERVED(A)]))
    return table([SERVED], [HOT, WASHED], demos)


def climb(
    source: TruthTable,
    learner: OperatorLearner | None = None,
    objective: DemoObjective | None = None,
    rule: StoppingRule | None = None,
) -> Selection:
    parts = HillClimbing(
        learner or operator_learner(PUBLISHED), objective or demo_objective(PUBLISHED), rule or stopping_rule(PUBLISHED)
    )
    return parts.fit(source)


def names(found: Selection) -> set[str]:
    return {p.name for p in found.selected}


def test_a_learner_from_outside() -> None:
    """Four of five are enough for the published share of 0.8."""
    assert names(climb(kitchen(cold=1))) == {"hot", "washed"}
    assert names(climb(kitchen(cold=1), learner=Unanimous())) == {"washed"}
    assert names(climb(kitchen(), learner=Unanimous())) == {"hot", "washed"}


def test_an_objective_from_outside() -> None:
    found = climb(kitchen(), objective=TooShort())
    assert [round(step.j) for step in found.steps] == [10, 5, 0]  # two steps missing in each of five demonstrations
    assert names(found) == {"hot", "washed"}


def test_a_stopping_rule_from_outside() -> None:
    assert names(climb(kitchen(), rule=Share(1e-3))) == {"hot", "washed"}
    assert names(climb(kitchen(), rule=Share(0.9))) == set()
