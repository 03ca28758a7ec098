"""A* with a closed set and re-opening (Hart, Nilsson and Raphael, 1968); optimal with an admissible heuristic."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.heuristics.lmcut_costs import landmark_cut
from pix2pred.planning.search.search import SearchResult, extract_plan
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class AStar:
    """Cheapest plans. Among equal f the deepest node is expanded first, then the oldest.

    ``heuristic`` builds the estimate for a task; ``max_nodes`` bounds the created nodes.
    """

    heuristic: Callable[[Strips], Heuristic] = landmark_cut
    max_nodes: int = 1_000_000

    def __call__(self, task: Strips) -> SearchResult:
        """Search ``task``; the plan is optimal when the heuristic is admissible."""
        estimate = self.heuristic(task)
        h = estimate(task.initial)
        if h is None:
            return SearchResult(PlanStatus.UNSOLVABLE, (), 1)
        best = {task.initial: 0}
        parent: dict[int, tuple[int, int]] = {}
        queue = [(h, h, 0, 0, task.initial)]
        nodes = 1
        while queue:
            _, _, _, g, state = heapq.heappop(queue)
            if g > best[state]:
                continue
            if not task.goal & ~state:
                return SearchResult(PlanStatus.SOLVED, extract_plan(task.initial, state, parent), nodes)
            for k in task.applicable(state):
                successor = task.successor(state, k)
                reached = g + task.cost(k)
                if best.get(successor, reached + 1) <= reached:
                    continue
                h = estimate.after(state, k, successor)
                if h is None:
                    continue
                best[successor] = reached
                parent[successor] = (state, k)
                if nodes >= self.max_nodes:
                    return SearchResult(PlanStatus.BUDGET, (), nodes)
                heapq.heappush(queue, (reached + h, h, nodes, reached, successor))
                nodes += 1
        return SearchResult(PlanStatus.UNSOLVABLE, (), nodes)
