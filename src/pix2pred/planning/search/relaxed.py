"""Following a plan without deletes as far as it goes.

Source of the idea: Vidal, "A lookahead strategy for heuristic search planning", 2004.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.planning.heuristics.easy_ff import EasyFF
from pix2pred.planning.heuristics.ff import FF
from pix2pred.planning.search.search import SearchResult
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class FollowRelaxed:
    """Takes the steps of the initial state's relaxed plan that can be taken, in several rounds.

    For relaxed plans of ``least_steps`` and more: every state that is evaluated then costs a lot, and such a plan may
    be all there is to find, as in long chains. The status is BUDGET where the goal is not reached.
    """

    heuristic: Callable[[Strips], FF] = EasyFF
    least_steps: int = 200

    def __call__(self, task: Strips) -> SearchResult:
        """Follow the relaxed plan of ``task``."""
        left = self.heuristic(task).relaxed_plan(task.initial)
        if left is None:
            return SearchResult(PlanStatus.UNSOLVABLE, (), 1)
        if len(left) < self.least_steps:
            return SearchResult(PlanStatus.BUDGET, (), 1)
        state = task.initial
        plan: list[int] = []
        progress = True
        while progress and not task.is_goal(state):
            waiting = []
            for k in left:
                if task.pre[k] & ~state:
                    waiting.append(k)
                else:
                    state = task.successor(state, k)
                    plan.append(k)
            progress = len(waiting) < len(left)
            left = waiting
        if task.is_goal(state):
            return SearchResult(PlanStatus.SOLVED, tuple(plan), 1)
        return SearchResult(PlanStatus.BUDGET, (), 1)
