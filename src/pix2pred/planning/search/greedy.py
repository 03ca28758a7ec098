"""Greedy best-first search with preferred operators (Helmert, "The Fast Downward planning system", 2006).

Two queues hold the open nodes, one of them only successors by operators that the heuristic prefers. They take turns;
progress (a new smallest estimate) gives the preferred queue a run of turns.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.planning.heuristics.ff import FF
from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.search.improving import improved
from pix2pred.planning.search.search import SearchResult, extract_plan
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus

PREFERRED_BOOST = 1000
"""Turns the preferred queue gains with every improvement of the smallest estimate (as in Fast Downward's LAMA)."""

Entry = tuple[int, int, int]
"""(estimate, order of creation, state)."""


@dataclass(frozen=True, slots=True)
class GreedyBestFirst:
    """Plans quickly, not necessarily cheapest ones.

    ``heuristic`` builds the estimate for a task, with the operators it prefers; ``max_nodes`` bounds the created nodes.
    Where operators differ in costs, which the search itself does not look at, its plan is made cheaper afterwards, with
    ``improving_nodes`` nodes.
    """

    heuristic: Callable[[Strips], Heuristic] = FF
    max_nodes: int = 1_000_000
    improving_nodes: int = 20_000

    def __call__(self, task: Strips) -> SearchResult:
        """Search ``task``. Complete: every node that is not a dead end is expanded at most once."""
        found = self._first(task)
        if not task.costs or found.status != PlanStatus.SOLVED:
            return found
        better = improved(task, found.plan, self.heuristic, min(self.improving_nodes, self.max_nodes - found.nodes))
        return SearchResult(found.status, better.plan, found.nodes + better.nodes)

    def _first(self, task: Strips) -> SearchResult:
        evaluate = self.heuristic(task).evaluate
        first = evaluate(task.initial)
        if first is None:
            return SearchResult(PlanStatus.UNSOLVABLE, (), 1)
        smallest, preferred_of = first.estimate, {task.initial: first.preferred}
        queues: tuple[list[Entry], list[Entry]] = ([(smallest, 0, task.initial)], [])
        turns = [0, 0]
        parent: dict[int, tuple[int, int]] = {}
        closed: set[int] = set()
        nodes = 1
        while any(queues):
            q = _next_queue(queues, turns)
            _, _, state = heapq.heappop(queues[q])
            if state in closed:
                continue
            closed.add(state)
            if not task.goal & ~state:
                return SearchResult(PlanStatus.SOLVED, extract_plan(task.initial, state, parent), nodes)
            for k in task.applicable(state):
                successor = task.successor(state, k)
                if successor in preferred_of:
                    continue
                evaluated = evaluate(successor)
                if evaluated is None:
                    continue
                if nodes >= self.max_nodes:
                    return SearchResult(PlanStatus.BUDGET, (), nodes)
                h, preferred_of[successor] = evaluated.estimate, evaluated.preferred
                parent[successor] = (state, k)
                heapq.heappush(queues[0], (h, nodes, successor))
                if preferred_of[state] >> k & 1:
                    heapq.heappush(queues[1], (h, nodes, successor))
                nodes += 1
                if h < smallest:
                    smallest = h
                    turns[1] -= PREFERRED_BOOST
        return SearchResult(PlanStatus.UNSOLVABLE, (), nodes)


def _next_queue(queues: tuple[list[Entry], list[Entry]], turns: list[int]) -> int:
    """The non-empty queue that has had the fewest turns; it is charged one."""
    q = 0 if not queues[1] or (queues[0] and turns[0] < turns[1]) else 1
    turns[q] += 1
    return q
