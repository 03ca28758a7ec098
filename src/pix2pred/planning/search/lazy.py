"""Greedy best-first search with deferred evaluation.

Source: Richter and Helmert, "Preferred operators and deferred evaluation in satisficing planning", 2009.

A state is evaluated when it is expanded, not when it is created: its successors wait with its own estimate. Where
states have many successors, few of them are ever evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.planning.search.satisficing import OpenNodes, Satisficing
from pix2pred.planning.search.search import SearchResult, extract_plan
from pix2pred.planning.strips import Strips, bits
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class LazyGreedy(Satisficing):
    """Plans quickly where states have many successors; ``max_nodes`` bounds the evaluated states."""

    def _first(self, task: Strips) -> SearchResult:
        evaluate = self.heuristic(task).evaluate
        waiting = OpenNodes[tuple[int, int]]()  # a state, and an operator whose successor is not made yet
        parent: dict[int, tuple[int, int]] = {}
        seen = {task.initial}
        state, nodes = task.initial, 0
        while nodes < self.max_nodes:
            nodes += 1
            found = evaluate(state)
            if task.is_goal(state):
                return SearchResult(PlanStatus.SOLVED, extract_plan(task.initial, state, parent), nodes)
            if found is not None:
                waiting.reached(found.estimate)
                for k in task.applicable(state):
                    waiting.push(found.estimate, (state, k))
                for k in bits(found.preferred):
                    waiting.push_preferred(found.estimate, (state, k))
            while state in seen:
                if not waiting:
                    return SearchResult(PlanStatus.UNSOLVABLE, (), nodes)
                before, k = waiting.pop()
                state = task.successor(before, k)
            seen.add(state)
            parent[state] = (before, k)
        return SearchResult(PlanStatus.BUDGET, (), nodes)
