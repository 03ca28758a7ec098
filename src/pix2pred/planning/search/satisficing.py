"""What the searches for any plan have in common: two queues of open nodes, and plans made cheaper afterwards.

One queue holds all open nodes, the other only those that the heuristic prefers. They take turns; progress (a new
smallest estimate) gives the preferred queue a run of turns.
"""

from __future__ import annotations

import heapq
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from pix2pred.planning.heuristics.ff import FF
from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.search.improving import improved
from pix2pred.planning.search.search import SearchResult
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus

PREFERRED_BOOST = 1000
"""Turns the preferred queue gains with every improvement of the smallest estimate (as in Fast Downward's LAMA)."""

Node = TypeVar("Node")


@dataclass(frozen=True, slots=True)
class Satisficing(ABC):
    """Plans quickly, not necessarily cheapest ones.

    ``heuristic`` builds the estimate for a task, with the operators it prefers; ``max_nodes`` bounds the nodes.
    Where operators differ in costs, which the search itself does not look at, its plan is made cheaper afterwards, with
    ``improving_nodes`` nodes, or fewer where nodes times operators would be more than ``improving_visits``.
    """

    heuristic: Callable[[Strips], Heuristic] = FF
    max_nodes: int = 1_000_000
    improving_nodes: int = 20_000
    improving_visits: int = 1_000_000

    def __call__(self, task: Strips) -> SearchResult:
        """Search ``task``. Complete: every state that is no dead end is expanded at most once."""
        found = self._first(task)
        if not task.costs or found.status != PlanStatus.SOLVED:
            return found
        by_work = self.improving_visits // max(1, len(task.pre))
        nodes = min(self.improving_nodes, by_work, self.max_nodes - found.nodes)
        better = improved(task, found.plan, self.heuristic, nodes)
        return SearchResult(found.status, better.plan, found.nodes + better.nodes)

    @abstractmethod
    def _first(self, task: Strips) -> SearchResult:
        """The first plan that is found."""


class OpenNodes(Generic[Node]):
    """Nodes to look at, by their estimates and then by age: all of them, and the preferred ones once more."""

    def __init__(self) -> None:
        self._queues: tuple[list[tuple[int, int, Node]], list[tuple[int, int, Node]]] = ([], [])
        self._turns = [0, 0]
        self._pushed = 0
        self._smallest: int | None = None

    def __bool__(self) -> bool:
        return any(self._queues)

    def push(self, estimate: int, node: Node) -> None:
        """Add ``node`` to the queue of all nodes."""
        self._push(0, estimate, node)

    def push_preferred(self, estimate: int, node: Node) -> None:
        """Add ``node`` to the queue of those that the heuristic prefers."""
        self._push(1, estimate, node)

    def _push(self, queue: int, estimate: int, node: Node) -> None:
        heapq.heappush(self._queues[queue], (estimate, self._pushed, node))
        self._pushed += 1

    def reached(self, estimate: int) -> None:
        """A state with ``estimate`` was evaluated: one smaller than all before is progress."""
        if self._smallest is not None and estimate < self._smallest:
            self._turns[1] -= PREFERRED_BOOST
        self._smallest = estimate if self._smallest is None else min(self._smallest, estimate)

    def pop(self) -> Node:
        """The next node of the queue, among those with nodes, that has had the fewest turns; it is charged one."""
        everything, preferred = self._queues
        q = 0 if not preferred or (everything and self._turns[0] < self._turns[1]) else 1
        self._turns[q] += 1
        return heapq.heappop(self._queues[q])[2]
