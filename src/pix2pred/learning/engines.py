"""From the setting ``engine`` to the objects that compute J and settle ties."""

from __future__ import annotations

from pix2pred.learning.exact_tree import ExactTree
from pix2pred.learning.grouped import Grouped
from pix2pred.learning.refinement import SkeletonSearch
from pix2pred.learning.selection import TieRule
from pix2pred.learning.settings import LearningSettings


def skeleton_search(settings: LearningSettings) -> SkeletonSearch:
    """How J_d is computed."""
    if settings.engine == "exact-tree":
        return ExactTree(settings.max_plans, settings.node_budget, settings.tie_seed)
    return Grouped(settings.max_plans, settings.node_budget)


def tie_rule(settings: LearningSettings) -> TieRule:
    """Which near-equal candidate wins: the published rule with ``exact-tree``, else within one search node."""
    return TieRule(0.0 if settings.engine == "exact-tree" else 1.0)
