"""A learner, an objective and a stopping rule from outside the package: docs/extending.md, word for word."""

from __future__ import annotations

from doc_runner import defined_in_extending
from learning.random_tables import BALL, candidate, demo, given, table
from pix2pred.learning import HillClimbing, Selection
from pix2pred.learning.objective.planning_effort import DemoObjective
from pix2pred.learning.operators.learner import OperatorLearner
from pix2pred.learning.selection.stopping_rule import StoppingRule
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.strategies import demo_objective, operator_learner, stopping_rule
from pix2pred.structs import Action, Object, Skill, TruthTable

PUBLISHED = LearningSettings(operators="cluster-and-intersect", j_threshold=0)


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
    assert names(climb(kitchen(cold=1), learner=defined_in_extending("Unanimous")())) == {"washed"}
    assert names(climb(kitchen(), learner=defined_in_extending("Unanimous")())) == {"hot", "washed"}


def test_an_objective_from_outside() -> None:
    found = climb(kitchen(), objective=defined_in_extending("TooShort")())
    assert [round(step.j) for step in found.steps] == [10, 5, 0]  # two steps missing in each of five demonstrations
    assert names(found) == {"hot", "washed"}


def test_a_stopping_rule_from_outside() -> None:
    assert names(climb(kitchen(), rule=defined_in_extending("Share")(1e-3))) == {"hot", "washed"}
    assert names(climb(kitchen(), rule=defined_in_extending("Share")(0.9))) == set()
