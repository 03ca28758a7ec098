"""LM-cut and FF against breadth-first search and a relaxed fixpoint."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.planning import FF, Evaluation, LMCut, Strips
from planning.random_tasks import random_strips, relaxed_reachable, shortest

SEEDS = st.integers(0, 2**32)
INDEPENDENT = Strips(3, (0, 0, 0), (0b001, 0b010, 0b100), (0, 0, 0), 0, 0b111)
CHAIN = Strips(4, (0b0001, 0b0010, 0b0100), (0b0010, 0b0100, 0b1000), (0, 0, 0), 0b0001, 0b1000)
JOINT = Strips(3, (0, 0), (0b011, 0b100), (0, 0), 0, 0b111)


def test_hand_worked_estimates() -> None:
    assert LMCut(INDEPENDENT)(0) == 3
    assert LMCut(INDEPENDENT)(0b101) == 1
    assert LMCut(CHAIN)(0b0001) == 3
    assert LMCut(JOINT)(0) == 2  # one operator adds two goals: counting goals would give 3
    assert FF(INDEPENDENT).evaluate(0) == Evaluation(3, 0b111)
    assert FF(CHAIN).evaluate(0b0001) == Evaluation(3, 0b001)  # only the first step applies at once
    assert FF(JOINT).evaluate(0) == Evaluation(2, 0b11)


def test_lm_cut_adds_up_landmarks_that_h_max_counts_once() -> None:
    # two arms of length two that meet in the goal: h-max says 2, the plan has 4 steps
    arms = Strips(4, (0, 0b0001, 0, 0b0100), (0b0001, 0b0010, 0b0100, 0b1000), (0, 0, 0, 0), 0, 0b1010)
    assert LMCut(arms)(0) == 4


def test_hostile_a_free_operator_without_preconditions_feeding_a_later_goal() -> None:
    task = Strips(3, (0, 0b001, 0b001, 0b110), (0b001, 0b010, 0b100, 0b001), (0, 0b001, 0b001, 0), 0, 0b110)
    assert LMCut(task)(0) == 3
    assert LMCut(task)(0b110) == 0
    assert LMCut(Strips(1, (0b1,), (0b1,), (0,), 0, 0b1))(0) is None  # adds only what it needs
    assert FF(Strips(1, (0b1,), (0b1,), (0,), 0, 0b1))(0) is None


@given(SEEDS)
@settings(max_examples=300, deadline=None)
def test_lm_cut_is_admissible_zero_at_goals_and_none_only_when_relaxed_unreachable(seed: int) -> None:
    task = random_strips(seed)
    estimate = LMCut(task)
    static = ~0
    for add, delete in zip(task.add, task.delete, strict=True):
        static &= ~(add | delete)
    for state in range(2**task.facts):
        if (state ^ task.initial) & static:
            continue  # static facts never differ from the initial state's
        h = estimate(state)
        assert (h is None) == (not relaxed_reachable(task, state))
        if h is not None:
            assert (h == 0) == (task.goal & state == task.goal)
            length = shortest(task, state)
            assert length is None or h <= length
        assert estimate(state) == h


@given(SEEDS)
@settings(max_examples=300, deadline=None)
def test_ff_is_none_iff_relaxed_unreachable_and_its_helpful_operators_apply(seed: int) -> None:
    task = random_strips(seed)
    found = FF(task).evaluate(task.initial)
    assert (found is None) == (not relaxed_reachable(task, task.initial))
    if found is not None:
        length, helpful = found.estimate, found.preferred
        assert (length == 0) == (task.goal & task.initial == task.goal)
        assert (helpful == 0) == (length == 0)
        applicable = set(task.applicable(task.initial))
        assert {k for k in range(len(task.pre)) if helpful >> k & 1} <= applicable
        assert helpful >> len(task.pre) == 0


@given(SEEDS)
@settings(max_examples=100, deadline=None)
def test_ff_never_underestimates_the_delete_free_optimum(seed: int) -> None:
    task = random_strips(seed)
    relaxed = Strips(task.facts, task.pre, task.add, tuple(0 for _ in task.pre), task.initial, task.goal)
    found = FF(task)(task.initial)
    optimum = shortest(relaxed)
    if found is not None:
        assert optimum is not None
        assert found >= optimum
