"""From settings to objects: the one place where names become learners, objectives and stopping rules.

Each table has a line per name; a new way to do one of these is a file of its own and a line here. From outside of the
package, or from Python, pass any object of the same form to ``HillClimbing``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from pix2pred.learning.objective.exact_tree import ExactTree
from pix2pred.learning.objective.expected_nodes import ExpectedNodes
from pix2pred.learning.objective.objective import Map
from pix2pred.learning.objective.planning_effort import DemoObjective
from pix2pred.learning.operators.cluster_and_intersect import ClusterAndIntersect
from pix2pred.learning.operators.learner import OperatorLearner
from pix2pred.learning.operators.lifted_types import LiftedTypes
from pix2pred.learning.operators.robust import Robust
from pix2pred.learning.operators.transition_class import to_operator
from pix2pred.learning.selection.explained_effort import ExplainedEffort
from pix2pred.learning.selection.hill_climbing import Climb, HillClimbing
from pix2pred.learning.selection.published_rules import ImprovementStop, LevelStop
from pix2pred.learning.selection.stopping_rule import StoppingRule
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Operator, Predicate, TruthTable
from pix2pred.system.garbage import seldom_collected

if TYPE_CHECKING:  # the settings know the names in these tables
    from pix2pred.learning.settings import LearningSettings

LEARNERS: Mapping[str, Callable[[LearningSettings], OperatorLearner]] = {
    "cluster-and-intersect": lambda s: ClusterAndIntersect(s.h_pre_frac, s.h_data_frac, s.strictly_more),
    "robust": lambda s: Robust(),
}
"""How operators are learned."""

OBJECTIVES: Mapping[str, Callable[[LearningSettings], DemoObjective]] = {
    "grouped": lambda s: ExpectedNodes(s.max_plans, s.node_budget),
    "exact-tree": lambda s: ExactTree(s.max_plans, s.node_budget, s.tie_seed),
}
"""How J of one demonstration is computed."""

STOPPING_RULES: Mapping[str, Callable[[LearningSettings], StoppingRule]] = {
    "level": lambda s: LevelStop(s.j_threshold, demo_objective(s).near_tie, s.drops_superseded),
    "improvement": lambda s: ImprovementStop(s.j_threshold, demo_objective(s).near_tie, s.drops_superseded),
    "explained": lambda s: ExplainedEffort(),
}
"""When the climb ends and what it takes."""

OWN_RULE: Mapping[str, str] = {"robust": "explained"}
"""Learners that come with a stopping rule of their own; with others ``early_stop`` names it."""


def operator_learner(settings: LearningSettings) -> OperatorLearner:
    """How operators are learned."""
    learner = LEARNERS[settings.operators](settings)
    return LiftedTypes(learner) if settings.lift_types else learner


def demo_objective(settings: LearningSettings) -> DemoObjective:
    """How J of one demonstration is computed."""
    return OBJECTIVES[settings.engine](settings)


def stopping_rule(settings: LearningSettings) -> StoppingRule:
    """When to stop and what to take: the learner's own rule if it has one, otherwise the one that is asked for."""
    return STOPPING_RULES[OWN_RULE.get(settings.operators, settings.early_stop)](settings)


def climbing(settings: LearningSettings, map_: Map = map) -> HillClimbing:
    """Hill climbing as ``settings`` ask for; ``map_`` may share the searches."""
    return HillClimbing(
        operator_learner(settings), demo_objective(settings), stopping_rule(settings), settings.static_demos, map_
    )


@seldom_collected()
def hill_climbing(
    table: TruthTable, settings: LearningSettings, map_: Map = map, pinned: Sequence[Predicate] = ()
) -> Climb:
    """A climb over ``table`` that selects when it is run, from ``pinned`` candidates on."""
    return climbing(settings, map_).start(IndexedTable(table), pinned)


def learn_operators(table: TruthTable, settings: LearningSettings) -> tuple[Operator, ...]:
    """Operators over all predicates of ``table``: the initial ones and the whole pool."""
    model = operator_learner(settings).fit(IndexedTable(table))
    everything = range(len(model.data.predicates))
    found = model.schemas(model.partition(everything), everything)
    return tuple(to_operator(model.data, schema) for schema in found)
