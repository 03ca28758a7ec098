"""The number of nodes follows from the task, and running out of any budget is called so."""

from __future__ import annotations

from pix2pred.planning import AStar, Bounded, Strips
from pix2pred.structs import PlanStatus

CHAIN = Strips(4, (1, 2, 4), (2, 4, 8), (0, 0, 0), 1, 8)
"""Three steps, one after the other."""


def bounded(nodes: int = 100, megabytes: int = 100, operator_visits: int = 10_000) -> Bounded:
    return Bounded(lambda n: AStar(max_nodes=n), nodes, megabytes, operator_visits)


def test_within_the_budgets_the_plan_is_found() -> None:
    assert bounded()(CHAIN).plan == (0, 1, 2)


def test_every_budget_bounds_the_nodes() -> None:
    assert bounded(nodes=7).allowed(CHAIN) == 7
    assert bounded(nodes=10**9, megabytes=1, operator_visits=10**9).allowed(CHAIN) == 2**20 // 601
    assert bounded(operator_visits=30).allowed(CHAIN) == 10


def test_out_of_budget_is_not_unsolvable() -> None:
    for search in (bounded(nodes=2), bounded(operator_visits=6), bounded(operator_visits=2), bounded(megabytes=0)):
        assert search(CHAIN).status == PlanStatus.BUDGET
