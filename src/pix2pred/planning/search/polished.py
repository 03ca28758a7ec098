"""A search whose plans are made shorter afterwards: needless steps go, and windows of the plan are planned anew.

Between the states around a window, and for what the rest of the plan needs, A* looks for fewer steps within a number of
nodes (as in block deordering and window optimisation: Siddiqui and Haslum, "Continuing plan quality optimisation",
2015). Nothing is counted in seconds: the same plan on every machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pix2pred.planning.search.astar import AStar
from pix2pred.planning.search.improving import cost_of, without_needless_steps
from pix2pred.planning.search.search import Search, SearchResult
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus

Shortened = tuple[tuple[int, ...], int]
"""A plan, and the nodes created for it."""


@dataclass(frozen=True, slots=True)
class Polished:
    """Plans with ``search``, then shortens: a window of steps is planned anew, the next one half a window later.

    ``passes`` over the plan are (steps of a window, nodes for each window); all together take ``nodes`` nodes, or fewer
    where nodes times operators would be more than ``visits``. Plans of more than ``most_steps``, and tasks in which
    these do not suffice for a window, are left as they are.
    """

    search: Search
    passes: tuple[tuple[int, int], ...] = ((8, 200), (16, 800))
    nodes: int = 4_000
    visits: int = 1_000_000
    most_steps: int = 500

    def __call__(self, task: Strips) -> SearchResult:
        """Search ``task``; the plan costs at most what the plan of ``search`` does."""
        found = self.search(task)
        if found.status != PlanStatus.SOLVED:
            return found
        plan = without_needless_steps(task, found.plan)
        spent = 0
        nodes = min(self.nodes, self.visits // max(1, len(task.pre))) if len(plan) <= self.most_steps else 0
        if type(task) is Strips:  # what a rest of a plan needs is not known where effects have conditions
            for window, each in self.passes if nodes >= self.passes[0][1] else ():
                plan, created = self._windows(task, plan, window, each, nodes - spent)
                spent += created
        return SearchResult(found.status, plan, found.nodes + spent)

    def _windows(self, task: Strips, plan: tuple[int, ...], window: int, each: int, nodes: int) -> Shortened:
        """The plan after one pass over its windows, and the nodes that were created."""
        spent = 0
        start = 0
        while start < len(plan) - 1 and spent < nodes:
            end = min(len(plan), start + window)
            before = task.initial
            for k in plan[:start]:
                before = task.successor(before, k)
            part = replace(task, initial=before, goal=needed(task, plan[end:]))
            found = AStar(max_nodes=min(each, nodes - spent))(part)
            spent += found.nodes
            if found.status == PlanStatus.SOLVED and cost_of(task, found.plan) < cost_of(task, plan[start:end]):
                plan = (*plan[:start], *found.plan, *plan[end:])
            start += max(1, window // 2)
        return plan, spent


def needed(task: Strips, plan: Sequence[int]) -> int:
    """The facts that must hold before ``plan`` so that it can be executed and reaches the goal."""
    facts = task.goal
    for k in reversed(plan):
        facts = facts & ~task.add[k] | task.pre[k]
    return facts
