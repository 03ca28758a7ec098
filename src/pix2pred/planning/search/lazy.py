"""Greedy best-first search with deferred evaluation.

Source: Richter and Helmert, "Preferred operators and deferred evaluation in satisficing planning", 2009.

A state is evaluated when it is expanded, not when it is created: its successors wait with its own estimate. Where
states have many successors, few of them are ever evaluated. Two queues hold the open nodes, one of them only successors
by operators that the heuristic prefers; progress gives the preferred queue a run of turns.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.planning.heuristics.ff import FF
from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.search.improving import improved
from pix2pred.planning.search.search import SearchResult, extract_plan
from pix2pred.planning.strips import Strips, bits
from pix2pred.structs import PlanStatus

PREFERRED_BOOST = 1000
"""Turns the preferred queue gains with every improvement of the smallest estimate (as in Fast Downward's LAMA)."""

Entry = tuple[int, int, int, int]
"""(estimate of the parent, order of creation, parent, operator): a node that is not made yet."""


@dataclass(frozen=True, slots=True)
class LazyGreedy:
    """Plans quickly where states have many successors. Settings as in ``GreedyBestFirst``.

    ``max_nodes`` bounds the evaluated states; a thousand times as many may wait.
    """

    heuristic: Callable[[Strips], Heuristic] = FF
    max_nodes: int = 1_000_000
    improving_nodes: int = 20_000

    def __call__(self, task: Strips) -> SearchResult:
        """Search ``task``. Complete: every state that is no dead end is expanded once."""
        found = self._first(task)
        if not task.costs or found.status != PlanStatus.SOLVED:
            return found
        better = improved(task, found.plan, self.heuristic, min(self.improving_nodes, self.max_nodes - found.nodes))
        return SearchResult(found.status, better.plan, found.nodes + better.nodes)

    def _first(self, task: Strips) -> SearchResult:
        evaluate = self.heuristic(task).evaluate
        queues: tuple[list[Entry], list[Entry]] = ([], [])
        turns = [0, 0]
        parent: dict[int, tuple[int, int]] = {}
        seen = {task.initial}
        smallest: int | None = None
        state, nodes, waiting = task.initial, 0, 0
        while True:
            if nodes >= self.max_nodes:
                return SearchResult(PlanStatus.BUDGET, (), nodes)
            nodes += 1
            found = evaluate(state)
            if task.is_goal(state):
                return SearchResult(PlanStatus.SOLVED, extract_plan(task.initial, state, parent), nodes)
            if found is not None:
                if smallest is not None and found.estimate < smallest:
                    turns[1] -= PREFERRED_BOOST
                smallest = found.estimate if smallest is None else min(smallest, found.estimate)
                for k in task.applicable(state):
                    waiting += 1
                    heapq.heappush(queues[0], (found.estimate, waiting, state, k))
                for k in bits(found.preferred):
                    waiting += 1
                    heapq.heappush(queues[1], (found.estimate, waiting, state, k))
            successor = None
            while successor is None:
                if not any(queues):
                    return SearchResult(PlanStatus.UNSOLVABLE, (), nodes)
                q = 0 if not queues[1] or (queues[0] and turns[0] < turns[1]) else 1
                turns[q] += 1
                _, _, before, k = heapq.heappop(queues[q])
                after = task.successor(before, k)
                if after not in seen:
                    seen.add(after)
                    parent[after] = (before, k)
                    successor = after
            state = successor
