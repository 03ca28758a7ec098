"""Grounding, heuristics and search: from operators and a goal to a plan."""

from pix2pred.planning.astar import AStar
from pix2pred.planning.bounded import Bounded
from pix2pred.planning.external import ExternalPlanner, ExternalPlannerError
from pix2pred.planning.ff import FF
from pix2pred.planning.greedy import GreedyBestFirst
from pix2pred.planning.grounding import GroundingBudgetError, GroundTask, ground
from pix2pred.planning.lmcut import LMCut
from pix2pred.planning.planner import Planner, Search, SearchResult, TaskPlanner
from pix2pred.planning.portfolio import Portfolio
from pix2pred.planning.strips import Strips
from pix2pred.planning.validate import is_valid

__all__ = [
    "FF",
    "AStar",
    "Bounded",
    "ExternalPlanner",
    "ExternalPlannerError",
    "GreedyBestFirst",
    "GroundTask",
    "GroundingBudgetError",
    "LMCut",
    "Planner",
    "Portfolio",
    "Search",
    "SearchResult",
    "Strips",
    "TaskPlanner",
    "ground",
    "is_valid",
]
