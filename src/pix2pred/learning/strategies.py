"""From settings to the objects that learn operators, compute J and settle ties."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.learning.objective.exact_tree import ExactTree
from pix2pred.learning.objective.expected_nodes import Grouped
from pix2pred.learning.objective.objective import Map
from pix2pred.learning.objective.planning_effort import SkeletonSearch
from pix2pred.learning.operators.cluster_and_intersect import to_operator
from pix2pred.learning.operators.learner import ClusterAndIntersect, OperatorLearner
from pix2pred.learning.operators.robust import Robust
from pix2pred.learning.selection.hill_climbing import HillClimbing
from pix2pred.learning.selection.stopping_rules import ClimbingRule, Explained, Published
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.transitions import Data
from pix2pred.structs import Operator, Predicate, TruthTable


def operator_learner(table: TruthTable, settings: LearningSettings) -> OperatorLearner:
    """How operators are learned."""
    if settings.operators == "robust":
        return Robust(Data(table))
    return ClusterAndIntersect(Data(table), settings)


def learn_operators(table: TruthTable, settings: LearningSettings) -> tuple[Operator, ...]:
    """Operators over all predicates of ``table``: the initial ones and the whole pool."""
    learner = operator_learner(table, settings)
    everything = range(len(learner.data.predicates))
    found = learner.schemas(learner.partition(everything), everything)
    return tuple(to_operator(learner.data, schema) for schema in found)


def hill_climbing(
    table: TruthTable, settings: LearningSettings, map_: Map = map, pinned: Sequence[Predicate] = ()
) -> HillClimbing:
    """Selection as ``settings`` ask for, from ``pinned`` candidates on; ``map_`` may share the searches."""
    learner = operator_learner(table, settings)
    return HillClimbing(
        learner, skeleton_search(settings), climbing_rule(settings), map_, pinned, settings.static_demos
    )


def skeleton_search(settings: LearningSettings) -> SkeletonSearch:
    """How J_d is computed."""
    if settings.engine == "exact-tree":
        return ExactTree(settings.max_plans, settings.node_budget, settings.tie_seed)
    return Grouped(settings.max_plans, settings.node_budget)


def climbing_rule(settings: LearningSettings) -> ClimbingRule:
    """When to stop and what to take: with robust operators nothing to tune, otherwise the published rules.

    Near-equal candidates compete within one search node, except with ``exact-tree``.
    """
    if settings.operators == "robust":
        return Explained()
    margin = 0.0 if settings.engine == "exact-tree" else 1.0
    return Published(settings.early_stop, settings.j_threshold, margin, settings.superseded == "drop")
