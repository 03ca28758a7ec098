"""Many states evaluated at once: relaxed plans, landmarks, operators that apply, and the search built on them."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.planning import FF, FollowRelaxed, LazyBatches, LazyGreedy, Polished, Portfolio, Strips
from pix2pred.planning.conditional import ConditionalStrips, When
from pix2pred.planning.heuristics import sliced_ff
from pix2pred.planning.heuristics.landmarks import LandmarkCount
from pix2pred.planning.heuristics.sliced_ff import SlicedFF
from pix2pred.planning.search.batches.successors import Successors
from pix2pred.planning.search.search import SearchResult
from pix2pred.planning.strips import bits
from pix2pred.structs import PlanStatus
from planning.random_tasks import random_strips, relaxed_reachable, run, shortest

SEEDS = st.integers(0, 2**32)


def reachable(task: Strips, most: int) -> list[int]:
    """Up to ``most`` states that can be reached, the initial one first."""
    found = {task.initial: None}
    for state in list(found):
        for k in task.applicable(state):
            found[task.successor(state, k)] = None
    frontier = list(found)
    while frontier and len(found) < most:
        state = frontier.pop(0)
        for k in task.applicable(state):
            after = task.successor(state, k)
            if after not in found:
                found[after] = None
                frontier.append(after)
    return list(found)[:most]


def delete_free(task: Strips, state: int, plan: set[int]) -> int:
    """The facts that the operators of ``plan`` reach from ``state``, in whatever order, without deletes."""
    before = -1
    while before != state:
        before = state
        for k in plan:
            if not task.pre[k] & ~state:
                state |= task.add[k]
    return state


@given(SEEDS, st.integers(1, 64))
@settings(max_examples=150, deadline=None)
def test_states_at_once_are_dead_where_one_alone_is_and_preferred_operators_apply(seed: int, count: int) -> None:
    task = random_strips(seed)
    states = reachable(task, count)
    found = SlicedFF(task)(states)
    alone = FF(task)
    assert len(found.estimates) == len(found.preferred) == len(states)
    for state, estimate, preferred in zip(states, found.estimates, found.preferred, strict=True):
        assert (estimate < 0) == (not relaxed_reachable(task, state)) == (alone(state) is None)
        assert (estimate == 0) == task.is_goal(state)
        assert set(preferred) <= set(task.applicable(state)) and bool(preferred) == (estimate > 0)
        assert estimate < 1 or delete_free(task, state, set(preferred)) != state


@given(SEEDS)
@settings(max_examples=150, deadline=None)
def test_what_states_are_evaluated_with_changes_nothing(seed: int) -> None:
    task = random_strips(seed)
    states = reachable(task, 64)
    together = SlicedFF(task)(states)
    for i, state in enumerate(states[:5]):
        single = SlicedFF(task)([state])
        assert (single.estimates[0], single.preferred[0]) == (together.estimates[i], together.preferred[i])


def test_the_way_of_which_fewer_preconditions_are_missing_is_taken() -> None:
    # fact 4 has two achievers in layer 2: operator 2 needs facts 1, 2 and 3 of layer 1, operator 3 fact 1 alone
    pre = (0b00001, 0b00001, 0b01110, 0b00010, 0b00001)
    add = (0b00010, 0b00100, 0b10000, 0b10000, 0b01000)
    task = Strips(5, pre, add, (0,) * 5, 0b00001, 0b10000)
    assert SlicedFF(task)([0b00001]).estimates == [2]
    assert SlicedFF(task)([0b00001]).preferred == [[0]]


def test_conditional_effects_and_what_happens_by_itself_are_not_counted_twice() -> None:
    task = ConditionalStrips(
        3, (0b001,), (0b000,), (0,), 0b001, 0b110,
        conditional=((When(0b001, 0b010, 0), When(0b010, 0b100, 0)),),
    )  # fmt: skip
    assert SlicedFF(task)([0b001]).estimates == [1], "one operator, taken twice, counts once without deletes"
    assert LazyBatches()(task).plan == (0, 0)


def test_relaxed_plans_of_too_many_layers_are_left_to_other_searches(monkeypatch: pytest.MonkeyPatch) -> None:
    chain = Strips(5, tuple(1 << i for i in range(4)), tuple(2 << i for i in range(4)), (0,) * 4, 1, 0b10000)
    monkeypatch.setattr(sliced_ff, "MAX_MEGABYTES", 0)
    assert LazyBatches()(chain) == SearchResult(PlanStatus.BUDGET, (), 1)
    assert Portfolio((LazyBatches(), LazyGreedy()))(chain).plan == (0, 1, 2, 3)


@given(SEEDS)
@settings(max_examples=200, deadline=None)
def test_the_search_is_complete_and_its_plans_work(seed: int) -> None:
    task = random_strips(seed)
    length = shortest(task)
    for search in (LazyBatches(), Polished(LazyBatches())):
        found = search(task)
        assert found.status == (PlanStatus.UNSOLVABLE if length is None else PlanStatus.SOLVED)
        final = run(task, found.plan)
        assert final is not None and (length is None or (task.is_goal(final) and len(found.plan) >= length))


def test_the_search_stops_at_its_budget() -> None:
    switches = Strips(12, (0,) * 12, tuple(1 << i for i in range(12)), (0,) * 12, 0, (1 << 12) - 1)
    found = LazyBatches(max_nodes=20)(switches)
    assert found.status == PlanStatus.BUDGET and 20 < found.nodes <= 20 + sliced_ff.STATES


@given(SEEDS)
@settings(max_examples=150, deadline=None)
def test_operators_that_apply_are_all_found_at_once(seed: int) -> None:
    task = random_strips(seed)
    applicable = Successors(task)
    for state in reachable(task, 20):
        assert applicable(state) == list(task.applicable(state))


@given(SEEDS)
@settings(max_examples=200, deadline=None)
def test_every_plan_reaches_all_landmarks_and_none_is_left_at_the_goal(seed: int) -> None:
    task = random_strips(seed)
    found = LazyGreedy()(task)
    if found.status != PlanStatus.SOLVED:
        return
    count = LandmarkCount(task)
    state, reached = task.initial, count.all & task.initial
    for k in found.plan:
        state = task.successor(state, k)
        reached = count.reached(reached, state)
    assert reached == count.all and count(reached, state) == 0


def test_a_landmark_that_is_lost_counts_again_when_the_next_needs_it() -> None:
    # a key (fact 1) is taken from place 0, may be dropped, and opens the door (fact 2)
    task = Strips(3, (0b001, 0b010, 0b010), (0b010, 0b000, 0b100), (0, 0b010, 0), 0b001, 0b100)
    count = LandmarkCount(task)
    assert list(bits(count.all)) == [0, 1, 2]
    taken = count.reached(0b001, 0b011)
    assert (taken, count(taken, 0b011), count(taken, 0b001)) == (0b011, 1, 2)
    assert count.reaches(taken, 0b100) and not count.reaches(0b001, 0b100), "the key comes first"


def test_a_relaxed_plan_that_works_is_all_there_is_to_find() -> None:
    chain = Strips(5, tuple(1 << i for i in range(4)), tuple(2 << i for i in range(4)), (0,) * 4, 1, 0b10000)
    assert FollowRelaxed(least_steps=1)(chain) == SearchResult(PlanStatus.SOLVED, (0, 1, 2, 3), 1)
    assert FollowRelaxed()(chain).status == PlanStatus.BUDGET, "small tasks are searched"
    swap = Strips(3, (0b001, 0b001), (0b010, 0b100), (0b001, 0b001), 0b001, 0b110)
    assert FollowRelaxed(least_steps=1)(swap).status == PlanStatus.BUDGET
    assert FollowRelaxed(least_steps=0)(Strips(1, (), (), (), 0, 1)).status == PlanStatus.UNSOLVABLE
