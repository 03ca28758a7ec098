"""Cheaper plans than the first one found, within a number of nodes.

Steps that the plan does not need are left out first (action elimination: Nakhost and Müller, "Action elimination and
plan neighborhood graph search", 2010). Then a weighted A* is run with smaller and smaller weights (Richter, Thayer and
Ruml, "The joy of forgetting: faster anytime search via restarting", 2010), each bounded by the best plan so far.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.search.search import extract_plan
from pix2pred.planning.strips import Strips

WEIGHTS = (5, 3, 2, 1)
"""How much the estimate counts against what was spent, search after search (as in Fast Downward's LAMA)."""

LONG_PLAN = 150
"""Steps from which on needless ones are left out in their order: all together costs their number to the third power."""

VERY_LONG_PLAN = 1_000
"""Steps from which on even that, which costs their number squared, takes more than a second."""


@dataclass(frozen=True, slots=True)
class Improved:
    """A plan, and how many nodes were created to make it cheaper."""

    plan: tuple[int, ...]
    nodes: int


def improved(task: Strips, plan: Sequence[int], heuristic: Callable[[Strips], Heuristic], max_nodes: int) -> Improved:
    """A plan of ``task`` that costs at most what ``plan`` does, found with ``max_nodes`` nodes."""
    best = without_needless_steps(task, plan)
    estimate = heuristic(task)
    nodes = 0
    for weight in WEIGHTS:
        while nodes < max_nodes:
            search = _BoundedSearch(task, estimate, weight, cost_of(task, best), max_nodes - nodes)
            found = search.run()
            nodes += search.nodes
            if found is None:
                break
            best = without_needless_steps(task, found)
    return Improved(best, nodes)


def cost_of(task: Strips, plan: Sequence[int]) -> int:
    """What the steps of ``plan`` cost together."""
    return sum(task.cost(k) for k in plan)


def without_needless_steps(task: Strips, plan: Sequence[int]) -> tuple[int, ...]:
    """``plan`` without steps that can be left out together with all that depend on them, dearest parts first.

    Of a long plan they are left out in their order, and a very long one stays as it is.
    """
    best = tuple(plan)
    if len(best) > LONG_PLAN:
        return _without_in_order(task, best) if len(best) <= VERY_LONG_PLAN else best
    shorter = True
    while shorter:
        shorter = False
        candidates = [left for i in range(len(best)) if (left := _without(task, best, i)) is not None]
        if candidates:
            best, shorter = min(candidates, key=lambda left: (cost_of(task, left), len(left))), True
    return best


def _without_in_order(task: Strips, plan: tuple[int, ...]) -> tuple[int, ...]:
    """``plan`` without the steps that it does not need, looked for from the first one on."""
    i = 0
    while i < len(plan):
        left = _without(task, plan, i)
        if left is None or cost_of(task, left) > cost_of(task, plan):
            i += 1
        else:
            plan = left
    return plan


def _without(task: Strips, plan: Sequence[int], leave_out: int) -> tuple[int, ...] | None:
    """``plan`` without a step and without those that cannot be executed then; ``None`` when the goal is missed."""
    state = task.initial
    kept = []
    for i, k in enumerate(plan):
        if i != leave_out and not task.pre[k] & ~state:
            state = task.successor(state, k)
            kept.append(k)
    return tuple(kept) if task.is_goal(state) else None


class _BoundedSearch:
    """Weighted A* for a plan that costs less than ``bound``."""

    def __init__(self, task: Strips, estimate: Heuristic, weight: int, bound: int, max_nodes: int) -> None:
        self._task, self._estimate, self._weight, self._bound, self._max = task, estimate, weight, bound, max_nodes
        self.nodes = 1

    def run(self) -> tuple[int, ...] | None:
        """The plan; ``None`` when there is none, or when the nodes are used up."""
        task = self._task
        best = {task.initial: 0}
        parent: dict[int, tuple[int, int]] = {}
        queue = [(0, 0, 0, task.initial)]
        while queue:
            _, _, spent, state = heapq.heappop(queue)
            if spent > best[state]:
                continue
            for k in task.applicable(state):
                successor = task.successor(state, k)
                reached = spent + task.cost(k)
                if reached >= self._bound or best.get(successor, reached + 1) <= reached:
                    continue
                h = self._estimate.after(state, k, successor)
                if h is None:
                    continue
                best[successor] = reached
                parent[successor] = (state, k)
                if task.is_goal(successor):
                    return extract_plan(task.initial, successor, parent)
                if self.nodes >= self._max:
                    return None
                heapq.heappush(queue, (reached + self._weight * h, self.nodes, reached, successor))
                self.nodes += 1
        return None
