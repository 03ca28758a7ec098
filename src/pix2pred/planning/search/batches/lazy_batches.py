"""Greedy best-first search with deferred evaluation, for which many states are evaluated at once.

Sources: deferred evaluation and preferred operators as in LAMA (Richter and Westphal, "The LAMA planner", 2010);
several of the best nodes at once (Felner, Kraus and Korf, "KBFS: K-best-first search", 2003).

Evaluating 64 states together costs hardly more than evaluating one, so the 64 most promising ones are always taken.
"""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.planning.search.satisficing import Satisficing
from pix2pred.planning.search.search import SearchResult, extract_plan
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class LazyBatches(Satisficing):
    """Plans quickly for large tasks, by relaxed plans and by landmarks; ``max_nodes`` bounds the evaluated states.

    The ``heuristic`` only makes plans cheaper afterwards. The status is BUDGET as well where relaxed plans have so many
    layers that evaluating states at once takes too much memory.
    """

    def _first(self, task: Strips) -> SearchResult:
        from pix2pred.planning.heuristics.sliced_ff import STATES, SlicedFF, TooDeepError  # loads numpy, as turns do
        from pix2pred.planning.search.batches.turns import DeferredNode, TakingTurns

        if task.is_goal(task.initial):
            return SearchResult(PlanStatus.SOLVED, (), 1)
        evaluate, waiting = SlicedFF(task), TakingTurns(task)
        parent: dict[int, tuple[int, int]] = {task.initial: (task.initial, -1)}
        batch = [waiting.first()]
        while batch and len(parent) <= self.max_nodes:
            try:
                found = evaluate([node.state for node in batch])
            except TooDeepError:
                return SearchResult(PlanStatus.BUDGET, (), len(parent))
            for node, estimate, preferred in zip(batch, found.estimates, found.preferred, strict=True):
                if estimate >= 0:
                    waiting.push(node, estimate, preferred)
            batch = []
            while len(batch) < STATES and (step := waiting.pop()):
                before, k = step
                state = task.successor(before.state, k)
                if state in parent:
                    continue
                parent[state] = (before.state, k)
                if task.is_goal(state):
                    return SearchResult(PlanStatus.SOLVED, extract_plan(task.initial, state, parent), len(parent))
                batch.append(DeferredNode(state, waiting.landmarks.reached(before.reached, state)))
        status = PlanStatus.BUDGET if batch else PlanStatus.UNSOLVABLE
        return SearchResult(status, (), len(parent))
