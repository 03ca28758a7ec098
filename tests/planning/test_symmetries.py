"""Objects that can be exchanged, and what J_d is when states alike up to such exchanges are one (method 6.6)."""

from __future__ import annotations

from math import inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.learning.objective.expected_nodes import ExpectedNodes
from pix2pred.planning import LMCut, Strips
from pix2pred.planning.search.astar import AStar
from pix2pred.planning.symmetries import Orbits
from pix2pred.structs import Type

BALL, HAND = Type("ball"), Type("hand")


def carrying(balls: int, hands: int, named: int | None = None) -> Strips:
    """Balls are picked with a hand and put into a box, where all, or the ``named`` one, have to be."""
    here, there = range(balls), range(balls, 2 * balls)
    held = {(b, h): 2 * balls + b * hands + h for b in range(balls) for h in range(hands)}
    free = range(2 * balls + balls * hands, 2 * balls + balls * hands + hands)
    operators = []
    for (b, h), fact in held.items():
        operators.append((1 << here[b] | 1 << free[h], 1 << fact, 1 << here[b] | 1 << free[h]))
        operators.append((1 << fact, 1 << there[b] | 1 << free[h], 1 << fact))
    atoms: list[tuple[int, ...]] = [(p, b) for p in (0, 1) for b in range(balls)]
    atoms += [(2, b, balls + h) for b, h in held] + [(3, balls + h) for h in range(hands)]
    goal = sum(1 << there[b] for b in (range(balls) if named is None else [named]))
    initial = sum(1 << here[b] for b in range(balls)) | sum(1 << f for f in free)
    pre, add, delete = zip(*operators, strict=True)
    kinds = (BALL,) * balls + (HAND,) * hands
    return Strips(len(atoms), pre, add, delete, initial, goal, atoms=tuple(atoms), kinds=kinds)


def test_states_alike_up_to_names_have_one_name() -> None:
    task = carrying(3, 2)
    orbits = Orbits(task)
    children = {task.successor(task.initial, k) for k in task.applicable(task.initial)}
    assert len(children) == 6
    assert len({orbits.name(state) for state in children}) == 1
    assert orbits.name(task.initial) == task.initial


def test_objects_that_the_goal_or_an_operator_tells_apart_are_not_exchanged() -> None:
    task = carrying(3, 1, named=1)
    orbits = Orbits(task)
    names = [orbits.name(task.successor(task.initial, k)) for k in task.applicable(task.initial)]
    assert len(set(names)) == 2, "the named ball, or one of the others"
    lame = Strips(
        task.facts, task.pre[1:], task.add[1:], task.delete[1:], task.initial, carrying(3, 1).goal,
        atoms=task.atoms, kinds=task.kinds,
    )  # fmt: skip
    orbits = Orbits(lame)
    moved = [lame.initial & ~(1 << b) | 1 << 3 + b for b in range(3)]
    assert orbits.name(moved[1]) == orbits.name(moved[2]) != orbits.name(moved[0]), "ball 0 is never picked"
    assert not Orbits(Strips(1, (0,), (1,), (0,), 0, 1))


@given(st.integers(1, 4), st.integers(1, 2), st.integers(2, 9))
@settings(max_examples=40, deadline=None)
def test_expected_nodes_do_not_depend_on_whether_states_alike_are_one(balls: int, hands: int, states: int) -> None:
    task = carrying(balls, hands)
    bare = Strips(task.facts, task.pre, task.add, task.delete, task.initial, task.goal)
    search = ExpectedNodes(200, 100_000, symmetries_after=0)
    apart, together = search(bare, states, inf), search(task, states, inf)
    assert together.value == pytest.approx(apart.value, rel=1e-6)
    assert together.charges == pytest.approx(apart.charges, rel=1e-6)


@given(st.integers(1, 4), st.integers(1, 3), st.booleans())
@settings(max_examples=30, deadline=None)
def test_optimal_plans_stay_optimal_and_take_fewer_nodes(balls: int, hands: int, one: bool) -> None:
    task = carrying(balls, hands, named=0 if one else None)
    apart, together = AStar(LMCut, symmetries_after=10**6)(task), AStar(LMCut, symmetries_after=1)(task)
    assert len(apart.plan) == len(together.plan) == (2 if one else 2 * balls)
    assert together.nodes <= apart.nodes
    state = task.initial
    for k in together.plan:
        assert not task.pre[k] & ~state
        state = task.successor(state, k)
    assert task.is_goal(state)
