"""A* with a closed set and re-opening (Hart, Nilsson and Raphael, 1968); optimal with an admissible heuristic."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.heuristics.lmcut_costs import landmark_cut
from pix2pred.planning.search.search import SearchResult, extract_plan
from pix2pred.planning.strips import Strips
from pix2pred.planning.symmetries import Orbits
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class AStar:
    """Cheapest plans. Among equal f the deepest node is expanded first, then the oldest.

    ``heuristic`` builds the estimate for a task; ``max_nodes`` bounds created nodes. Once ``symmetries_after`` nodes
    were created, a state is left out if one that is alike up to the names of interchangeable objects was reached as
    cheaply: its cheapest plan is as cheap.
    """

    heuristic: Callable[[Strips], Heuristic] = landmark_cut
    max_nodes: int = 1_000_000
    symmetries_after: int = 1_000

    def __call__(self, task: Strips) -> SearchResult:
        """Search ``task``; the plan is optimal when the heuristic is admissible."""
        estimate = self.heuristic(task)
        h = estimate(task.initial)
        if h is None:
            return SearchResult(PlanStatus.UNSOLVABLE, (), 1)
        best = {task.initial: 0}
        name: Callable[[int], int] = int
        parent: dict[int, tuple[int, int]] = {}
        queue = [(h, h, 0, 0, task.initial)]
        nodes = 1
        while queue:
            _, _, _, g, state = heapq.heappop(queue)
            if g > best[name(state)]:
                continue
            if not task.goal & ~state:
                return SearchResult(PlanStatus.SOLVED, extract_plan(task.initial, state, parent), nodes)
            for k in task.applicable(state):
                successor = task.successor(state, k)
                reached = g + task.cost(k)
                if best.get(named := name(successor), reached + 1) <= reached:
                    continue
                h = estimate.after(state, k, successor)
                if h is None:
                    continue
                best[named] = reached
                parent[successor] = (state, k)
                if nodes >= self.max_nodes:
                    return SearchResult(PlanStatus.BUDGET, (), nodes)
                heapq.heappush(queue, (reached + h, h, nodes, reached, successor))
                nodes += 1
                if nodes == self.symmetries_after and (orbits := Orbits(task)):
                    name = orbits.name
                    best = _renamed(best, name)
        return SearchResult(PlanStatus.UNSOLVABLE, (), nodes)


def _renamed(best: dict[int, int], name: Callable[[int], int]) -> dict[int, int]:
    """What the cheapest of all states with one name costs."""
    found: dict[int, int] = {}
    for state, g in best.items():
        found[name(state)] = min(g, found.get(name(state), g))
    return found
