"""Open nodes of a search with deferred evaluation, in queues that take turns.

Nodes wait by the lengths of their relaxed plans and by the landmarks that are still to be reached, in both cases with
all their operators and once more with the preferred ones alone. Every eighth node is drawn from all of them by type.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass, field

from pix2pred.planning.heuristics.landmarks import LandmarkCount
from pix2pred.planning.search.batches.by_type import ByType
from pix2pred.planning.search.batches.successors import Successors
from pix2pred.planning.search.satisficing import PREFERRED_BOOST
from pix2pred.planning.strips import Strips

DRAWN = 8
"""Of so many operators taken one is of a drawn node. Of 3 and 8, tried on four tasks, 8 was as good or better."""


@dataclass(slots=True)
class DeferredNode:
    """A state with the landmarks reached on the way to it.

    ``operators`` are all that apply and ``preferred`` those to try first, once they were looked for.
    """

    state: int
    reached: int
    preferred: list[int] = field(default_factory=list)
    operators: list[int] | None = None


@dataclass(slots=True, order=True)
class _Waiting:
    """A node in a queue, by its estimate and then by age; ``left`` are the operators not taken there yet."""

    estimate: int
    age: int
    node: DeferredNode = field(compare=False)
    left: Iterator[int] | None = field(default=None, compare=False)


class TakingTurns:
    """Open nodes of ``task``. Progress of either estimate gives the queues of preferred operators a run of turns."""

    def __init__(self, task: Strips) -> None:
        self.landmarks = LandmarkCount(task)
        self._task = task
        self._applicable = Successors(task)
        self._queues: tuple[list[_Waiting], ...] = ([], [], [], [])  # preferred, all; by relaxed plans, by landmarks
        self._types = ByType[_Waiting]()
        self._turns = [0, 0, 0, 0]
        self._taken = 0
        self._smallest: list[int | None] = [None, None]
        self._age = 0

    def first(self) -> DeferredNode:
        """The node of the initial state."""
        state = self._task.initial
        return DeferredNode(state, self.landmarks.all & state)

    def push(self, node: DeferredNode, estimate: int, preferred: list[int]) -> None:
        """Let ``node`` wait, whose relaxed plan has ``estimate`` steps and begins with the operators ``preferred``."""
        node.preferred = preferred
        self._age += 1
        estimates = estimate, self.landmarks(node.reached, node.state)
        self._types.push(estimates, _Waiting(estimate, self._age, node))
        for kind, value in enumerate(estimates):
            smallest = self._smallest[kind]
            if smallest is None or value < smallest:
                self._smallest[kind] = value
                self._turns[0] -= PREFERRED_BOOST
                self._turns[1] -= PREFERRED_BOOST
            heapq.heappush(self._queues[kind], _Waiting(value, self._age, node))
            heapq.heappush(self._queues[2 + kind], _Waiting(value, self._age, node))

    def pop(self) -> tuple[DeferredNode, int] | None:
        """The next node with one of its operators; ``None`` when no node is left."""
        while any(self._queues):
            q = min((q for q in range(4) if self._queues[q]), key=self._turns.__getitem__)
            drawn = self._taken % DRAWN == 0 and bool(self._types)
            entry = self._types.draw() if drawn else self._queues[q][0]
            if entry.left is None:
                entry.left = iter(self._operators(entry.node, only_preferred=q < 2 and not drawn))
            k = next(entry.left, None)
            if k is not None:
                self._taken += 1
                self._turns[q] += not drawn
                return entry.node, k
            if drawn:
                self._types.drop()
            else:
                heapq.heappop(self._queues[q])
        return None

    def _operators(self, node: DeferredNode, *, only_preferred: bool) -> list[int]:
        """The operators to take from ``node``. Preferred are also those that reach a landmark which is next."""
        if node.operators is None:
            node.operators = self._applicable(node.state)
            new = self.landmarks.all & ~node.reached
            add, reaches = self._task.add, self.landmarks.reaches
            reaching = (k for k in node.operators if add[k] & new and reaches(node.reached, add[k]))
            node.preferred = sorted({*node.preferred, *reaching})
        return node.preferred if only_preferred else node.operators
