"""A search whose node budget follows from what a task costs in nodes, memory and work; no seconds are counted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.planning.search.search import Search, SearchResult
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus

NODE_BYTES = 600
"""What a node of our searches takes besides its bits: entries of queues and tables."""


@dataclass(frozen=True, slots=True)
class Bounded:
    """Runs ``search(nodes)``, with as many nodes as all budgets allow. Beyond them the status is BUDGET.

    ``nodes`` bounds created nodes, ``megabytes`` what they take, and ``operator_visits`` nodes times ground operators,
    the work of a heuristic: a task of many operators gets fewer nodes. The same on every machine.
    """

    search: Callable[[int], Search]
    nodes: int
    megabytes: int
    operator_visits: int

    def __call__(self, task: Strips) -> SearchResult:
        """Search ``task`` within the budgets."""
        allowed = self.allowed(task)
        if allowed < 1:
            return SearchResult(PlanStatus.BUDGET, (), 0)
        return self.search(allowed)(task)

    def allowed(self, task: Strips) -> int:
        """The nodes that all budgets allow."""
        by_memory = self.megabytes * 2**20 // (NODE_BYTES + 2 * task.facts // 8)
        by_work = self.operator_visits // max(1, len(task.pre))
        return min(self.nodes, by_memory, by_work)
