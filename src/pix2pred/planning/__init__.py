"""Grounding, heuristics and search: from operators and a goal to a plan."""

from pix2pred.planning.external.planner import ExternalPlanner, ExternalPlannerError
from pix2pred.planning.grounding import GroundingBudgetError, GroundTask, ground
from pix2pred.planning.heuristics.easy_ff import EasyFF
from pix2pred.planning.heuristics.ff import FF
from pix2pred.planning.heuristics.heuristic import Evaluation, Heuristic
from pix2pred.planning.heuristics.lmcut import LMCut
from pix2pred.planning.heuristics.lmcut_costs import landmark_cut
from pix2pred.planning.planner import Planner, TaskPlanner
from pix2pred.planning.search.astar import AStar
from pix2pred.planning.search.batches.lazy_batches import LazyBatches
from pix2pred.planning.search.bounded import Bounded
from pix2pred.planning.search.greedy import GreedyBestFirst
from pix2pred.planning.search.lazy import LazyGreedy
from pix2pred.planning.search.one_by_one import OneByOne
from pix2pred.planning.search.polished import Polished
from pix2pred.planning.search.portfolio import Portfolio
from pix2pred.planning.search.relaxed import FollowRelaxed
from pix2pred.planning.search.search import Search, SearchResult
from pix2pred.planning.strips import Strips
from pix2pred.planning.validate import is_valid

__all__ = [
    "FF",
    "AStar",
    "Bounded",
    "EasyFF",
    "Evaluation",
    "ExternalPlanner",
    "ExternalPlannerError",
    "FollowRelaxed",
    "GreedyBestFirst",
    "GroundTask",
    "GroundingBudgetError",
    "Heuristic",
    "LMCut",
    "LazyBatches",
    "LazyGreedy",
    "OneByOne",
    "Planner",
    "Polished",
    "Portfolio",
    "Search",
    "SearchResult",
    "Strips",
    "TaskPlanner",
    "ground",
    "is_valid",
    "landmark_cut",
]
