"""Planning for one goal after the other."""

from __future__ import annotations

from pathlib import Path

import pytest

from pix2pred.planning import OneByOne, Planner, Strips, is_valid
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.structs import PlanStatus

DATA = Path(__file__).parents[1] / "data" / "pddl"


def chains(count: int, length: int) -> Strips:
    """``count`` goals, each at the end of ``length`` steps that have nothing to do with the others."""
    pre, add, goal = [], [], 0
    for chain in range(count):
        for step in range(length):
            fact = chain * (length + 1) + step
            pre.append(1 << fact)
            add.append(1 << fact + 1)
        goal |= 1 << chain * (length + 1) + length
    initial = sum(1 << chain * (length + 1) for chain in range(count))
    return Strips(count * (length + 1), tuple(pre), tuple(add), (0,) * len(pre), initial, goal)


def test_many_goals_take_as_many_steps_as_each_alone() -> None:
    task = chains(8, 5)
    found = OneByOne()(task)
    assert found.status == PlanStatus.SOLVED and len(found.plan) == 40
    state = task.initial
    for k in found.plan:
        assert not task.pre[k] & ~state
        state = task.successor(state, k)
    assert task.is_goal(state)


def test_short_tasks_and_those_with_costs_are_left_to_others() -> None:
    task = chains(3, 4)
    assert OneByOne()(task).status == PlanStatus.BUDGET
    assert OneByOne(least_steps=12)(task).status == PlanStatus.SOLVED
    priced = Strips(task.facts, task.pre, task.add, task.delete, task.initial, task.goal, (2,) * len(task.pre))
    assert OneByOne(least_steps=1)(priced).status == PlanStatus.BUDGET


def test_a_goal_out_of_reach_is_told_and_too_few_nodes_are_no_proof() -> None:
    task = chains(2, 3)
    lost = Strips(task.facts, task.pre, task.add, task.delete, 1, task.goal)
    assert OneByOne(least_steps=1)(lost).status == PlanStatus.UNSOLVABLE
    assert OneByOne(least_steps=1, each=2)(task).status == PlanStatus.BUDGET


def test_a_way_to_one_goal_that_bars_another_is_not_taken() -> None:
    """Facts: 0 the only glass, 1 the only jar, 2 water, 3 wine. Water goes into either, wine into the glass alone."""
    pre, add, delete = (0b01, 0b10, 0b01), (0b0100, 0b0100, 0b1000), (0b01, 0b10, 0b01)
    found = OneByOne(least_steps=1)(Strips(4, pre, add, delete, 0b0011, 0b1100))
    assert found.status == PlanStatus.SOLVED and set(found.plan) == {1, 2}


def test_a_goal_that_the_way_to_another_undoes_is_reached_again_and_endless_turns_end() -> None:
    """Facts: 0 the jar is empty, 1 it is full, 2 and 3 are drinks, each poured from an empty jar, which fills it."""
    pre, add, delete = (0b0001, 0b0001, 0b0010), (0b0110, 0b1010, 0b0001), (0b0001, 0b0001, 0b0010)
    found = OneByOne(least_steps=1)(Strips(4, pre, add, delete, 0b0010, 0b1101))
    assert found.status == PlanStatus.SOLVED and sorted(found.plan) == [0, 1, 2, 2, 2]
    switched = Strips(2, (0b10, 0b01), (0b01, 0b10), (0b10, 0b01), 0b01, 0b11)
    assert OneByOne(least_steps=1)(switched).status == PlanStatus.BUDGET


def test_a_tool_is_put_away_after_what_it_is_needed_for_though_that_is_nearer() -> None:
    """Facts: 0 the tool is in the hand, 1 it is away, 2 the hand is at the board, 3 the board is wiped."""
    pre, add, delete = (0b0001, 0b0010, 0b0000, 0b0101), (0b0010, 0b0001, 0b0100, 0b1000), (0b0001, 0b0010, 0, 0)
    found = OneByOne(least_steps=1)(Strips(4, pre, add, delete, 0b0001, 0b1010))
    assert found.status == PlanStatus.SOLVED and found.plan == (2, 3, 0)


def test_goals_that_each_have_to_be_undone_for_the_other_are_tried_all_the_same() -> None:
    """Facts: 0 and 1 are two doors, 2 is the only key: opening a door takes it, closing the door gives it back."""
    pre, add, delete = (0b100, 0b100, 0b001, 0b010), (0b001, 0b010, 0b100, 0b100), (0b100, 0b100, 0b001, 0b010)
    assert OneByOne(least_steps=1)(Strips(3, pre, add, delete, 0b100, 0b011)).status == PlanStatus.BUDGET


@pytest.mark.parametrize("name", ["stacks-test6", "combo-test1"])
def test_published_problems_have_valid_plans(name: str) -> None:
    path = DATA / f"{name}.pddl"
    domain = read_domain((DATA / f"{_domain_of(path.read_text())}-domain.pddl").read_text())
    problem = read_problem(path.read_text(), domain)
    search = OneByOne(least_steps=1)
    found = Planner(search, distinct=domain.distinct).plan(
        domain.operators, problem.objects, problem.initial, problem.goal
    )
    assert found.status == PlanStatus.SOLVED and is_valid(found.plan, problem.initial, problem.goal)


def _domain_of(text: str) -> str:
    return text.partition("(:domain ")[2].partition(")")[0]
