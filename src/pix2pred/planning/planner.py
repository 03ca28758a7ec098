"""What a planner is, and planning from symbols to symbols around a search on bits."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from pix2pred.planning.grounding import DEFAULT_BUDGET, GroundingBudgetError, ground
from pix2pred.planning.search.search import Search
from pix2pred.structs import AbstractState, Atom, Object, Operator, PlanResult, PlanStatus
from pix2pred.system.garbage import seldom_collected


class TaskPlanner(Protocol):
    """What makes plans: ``Planner`` around a search of ours, or ``ExternalPlanner``."""

    def plan(
        self, operators: Sequence[Operator], objects: Iterable[Object], initial: AbstractState, goal: Iterable[Atom]
    ) -> PlanResult:
        """Look for a plan from ``initial`` to a state that contains ``goal``."""
        ...


@dataclass(frozen=True, slots=True)
class Planner:
    """Grounds a task, leaves out operators without effects, searches, and names the result.

    ``max_operators`` bounds the reachable ground operators; beyond it the status is BUDGET.
    """

    search: Search
    max_operators: int = DEFAULT_BUDGET
    distinct: bool = True

    @seldom_collected()
    def plan(
        self, operators: Sequence[Operator], objects: Iterable[Object], initial: AbstractState, goal: Iterable[Atom]
    ) -> PlanResult:
        """Look for a plan from ``initial`` to a state that contains ``goal`` (method 8)."""
        start = time.perf_counter()
        effective = [op for op in operators if op.add or op.delete]
        try:
            task = ground(effective, objects, initial, tuple(goal), distinct=self.distinct, budget=self.max_operators)
        except GroundingBudgetError:
            return PlanResult(PlanStatus.BUDGET, (), 0, time.perf_counter() - start)
        if not task.goal_reachable:
            return PlanResult(PlanStatus.UNSOLVABLE, (), 0, time.perf_counter() - start)
        found = self.search(task.strips)
        plan = tuple(operator.ground(bound) for operator, bound in (task.instances[k] for k in found.plan))
        return PlanResult(found.status, plan, found.nodes, time.perf_counter() - start)
