"""Greedy best-first search with preferred operators (Helmert, "The Fast Downward planning system", 2006)."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.planning.search.satisficing import OpenNodes, Satisficing
from pix2pred.planning.search.search import SearchResult, extract_plan
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class GreedyBestFirst(Satisficing):
    """Evaluates every state when it is created; ``max_nodes`` bounds the created states."""

    def _first(self, task: Strips) -> SearchResult:
        evaluate = self.heuristic(task).evaluate
        first = evaluate(task.initial)
        if first is None:
            return SearchResult(PlanStatus.UNSOLVABLE, (), 1)
        preferred_of = {task.initial: first.preferred}
        waiting = OpenNodes[int]()
        waiting.push(first.estimate, task.initial)
        waiting.reached(first.estimate)
        parent: dict[int, tuple[int, int]] = {}
        closed: set[int] = set()
        nodes = 1
        while waiting:
            state = waiting.pop()
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
                preferred_of[successor] = evaluated.preferred
                parent[successor] = (state, k)
                waiting.push(evaluated.estimate, successor)
                if preferred_of[state] >> k & 1:
                    waiting.push_preferred(evaluated.estimate, successor)
                waiting.reached(evaluated.estimate)
                nodes += 1
        return SearchResult(PlanStatus.UNSOLVABLE, (), nodes)
