"""Deferred evaluation, easy achievers, and plans made shorter afterwards."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.planning import FF, AStar, GreedyBestFirst, Strips
from pix2pred.planning.heuristics.easy_ff import EasyFF
from pix2pred.planning.search.improving import improved, without_needless_steps
from pix2pred.planning.search.lazy import LazyGreedy
from pix2pred.planning.search.polished import Polished, needed
from pix2pred.planning.search.search import SearchResult
from pix2pred.structs import PlanStatus
from planning.random_tasks import random_strips, relaxed_reachable, run, shortest

SEEDS = st.integers(0, 2**32)


@given(SEEDS)
@settings(max_examples=200, deadline=None)
def test_deferred_evaluation_is_complete_and_its_plans_work(seed: int) -> None:
    task = random_strips(seed)
    length = shortest(task)
    for search in (LazyGreedy(), LazyGreedy(EasyFF), Polished(LazyGreedy(EasyFF))):
        found = search(task)
        assert found.status == (PlanStatus.UNSOLVABLE if length is None else PlanStatus.SOLVED)
        final = run(task, found.plan)
        assert final is not None and (length is None or (task.is_goal(final) and len(found.plan) >= length))


def test_a_lazy_search_stops_at_its_budget() -> None:
    switches = Strips(6, (0,) * 6, tuple(1 << i for i in range(6)), (0,) * 6, 0, 0b111111)
    assert LazyGreedy(max_nodes=3)(switches) == SearchResult(PlanStatus.BUDGET, (), 3)


@given(SEEDS)
@settings(max_examples=200, deadline=None)
def test_easy_ff_is_none_iff_relaxed_unreachable_and_its_helpful_operators_apply(seed: int) -> None:
    task = random_strips(seed)
    found = EasyFF(task).evaluate(task.initial)
    assert (found is None) == (not relaxed_reachable(task, task.initial))
    if found is not None:
        applicable = set(task.applicable(task.initial))
        assert {k for k in range(len(task.pre)) if found.preferred >> k & 1} <= applicable
        assert (found.estimate == 0) == task.is_goal(task.initial)


def test_easy_ff_takes_the_achiever_whose_preconditions_come_first() -> None:
    # fact 4 has two achievers in layer 2: operator 2 needs facts 1, 2 and 3 of layer 1, operator 3 fact 1 alone
    pre = (0b00001, 0b00001, 0b01110, 0b00010, 0b00001)
    add = (0b00010, 0b00100, 0b10000, 0b10000, 0b01000)
    task = Strips(5, pre, add, (0,) * 5, 0b00001, 0b10000)
    assert EasyFF(task)(0b00001) == 2
    assert FF(task)(0b00001) == 4


@given(SEEDS)
@settings(max_examples=200, deadline=None)
def test_improved_plans_work_and_cost_no_more(seed: int) -> None:
    task = random_strips(seed)
    found = GreedyBestFirst()(task)
    if found.status != PlanStatus.SOLVED:
        return
    detour = tuple(k for k in found.plan for _ in range(2) if run(task, found.plan) is not None)
    for plan in (found.plan, detour):
        final = run(task, plan)
        if final is None or not task.is_goal(final):
            continue
        for better in (without_needless_steps(task, plan), improved(task, plan, FF, 50).plan):
            end = run(task, better)
            assert end is not None and task.is_goal(end) and len(better) <= len(plan)
        assert needed(task, plan) & ~task.initial == 0


def test_needless_steps_go_with_all_that_depend_on_them() -> None:
    # 0 reaches the goal; 1 and 2 are a detour of which 2 depends on 1
    task = Strips(4, (0b0001, 0b0001, 0b0100), (0b0010, 0b0100, 0b1000), (0, 0, 0), 0b0001, 0b0010)
    assert without_needless_steps(task, (1, 2, 0)) == (0,)


def test_a_window_is_planned_anew() -> None:
    # a chain of four steps where one operator does the same at once
    chain = Strips(
        5,
        (0b00001, 0b00010, 0b00100, 0b01000, 0b00001),
        (0b00010, 0b00100, 0b01000, 0b10000, 0b10000),
        (0b00001, 0b00010, 0b00100, 0b01000, 0b00001),
        0b00001,
        0b10000,
    )

    def around(task: Strips) -> SearchResult:
        return SearchResult(PlanStatus.SOLVED, (0, 1, 2, 3), 5)

    assert AStar()(chain).plan == Polished(around)(chain).plan == (4,)
    assert Polished(around, passes=((2, 200),))(chain).plan == (0, 1, 2, 3)
    assert Polished(around, passes=((2, 200), (4, 200)))(chain).plan == (4,), "a longer window sees more"


def test_an_unsolved_task_is_not_polished() -> None:
    assert Polished(LazyGreedy())(Strips(1, (), (), (), 0, 1)).status == PlanStatus.UNSOLVABLE
