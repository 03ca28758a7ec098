"""Planners by name: the part of the registry that commands need that only plan, without models and pictures."""

from __future__ import annotations

from collections.abc import Callable

from pix2pred.planning import (
    FF,
    AStar,
    Bounded,
    EasyFF,
    ExternalPlanner,
    FollowRelaxed,
    GreedyBestFirst,
    Heuristic,
    LazyBatches,
    LazyGreedy,
    OneByOne,
    Planner,
    Polished,
    Portfolio,
    Search,
    Strips,
    TaskPlanner,
    landmark_cut,
)
from pix2pred.planning.external.planner import ENGINES, TIME_LIMIT
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.system.installed import load, named

HEURISTICS: dict[str, Callable[[Strips], Heuristic]] = {
    "lmcut": landmark_cut,
    "ff": FF,
    "ff-easy": EasyFF,
}
"""Classes made from a ground task; group ``pix2pred.heuristics``."""

SEARCHES: dict[str, Callable[[Callable[[Strips], Heuristic]], Search]] = {
    "astar": AStar,
    "gbfs": GreedyBestFirst,
    "lazy": LazyGreedy,
}
"""Every search goes with every heuristic: a planner is called SEARCH-HEURISTIC."""

PORTFOLIOS: dict[str, Callable[[], Search]] = {
    "portfolio": lambda: Portfolio((AStar(max_nodes=500), OneByOne(), AStar(max_nodes=5_000), GreedyBestFirst())),
    "batches": LazyBatches,
    "quick": lambda: Polished(
        Portfolio(
            (
                FollowRelaxed(),
                Bounded(lambda nodes: GreedyBestFirst(max_nodes=nodes), 2_000, 1_000, 500_000),
                LazyBatches(),
                LazyGreedy(EasyFF, max_nodes=200_000),
            )
        )
    ),
}
"""``portfolio``, the default, plans optimally where that is cheap, else for one goal after the other where plans are
long, else greedily; the others are for large tasks.

Searches of other packages, callables from a ground task to a ``SearchResult``, come from the group
``pix2pred.searches``.
"""


class Planners:
    """Names to planners."""

    def planner(self, name: str, *, distinct: bool = True, time_limit: float = TIME_LIMIT) -> TaskPlanner:
        """The planner called ``name``: a search of ours or an engine of others.

        ``distinct`` parameters stand for distinct objects; ``time_limit`` in seconds binds external engines alone.
        Raises ``UnknownNameError``, or ``ExternalPlannerError`` for an engine that is not installed.
        """
        if name in ENGINES:
            return ExternalPlanner(name, distinct, time_limit)
        if name not in self.planner_names():
            raise UnknownNameError("planner", name, (*self.planner_names(), *ENGINES), listed=True)
        if name in PORTFOLIOS:
            return Planner(PORTFOLIOS[name](), distinct=distinct)
        if name in (others := named("searches", {})):
            return Planner(load(others[name]), distinct=distinct)
        search, _, heuristic = name.partition("-")
        made = HEURISTICS[heuristic] if heuristic in HEURISTICS else load(named("heuristics", {})[heuristic])
        return Planner(SEARCHES[search](made), distinct=distinct)

    def planner_names(self) -> tuple[str, ...]:
        """The names of all planners that are no engines of others."""
        heuristics = (*HEURISTICS, *named("heuristics", {}))
        return (*(f"{search}-{h}" for search in SEARCHES for h in heuristics), *PORTFOLIOS, *named("searches", {}))
