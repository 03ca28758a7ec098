"""Grounding against naive enumeration with a relaxed fixpoint."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.planning import GroundingBudgetError, GroundTask, ground
from pix2pred.planning.grounding import check_size
from pix2pred.structs import Atom, LiftedAtom, Object, Operator, Skill, Variable
from planning.random_tasks import BALL, BOX, RED_BALL, THING, naive_ground, named, predicate, random_lifted

X, Y = Variable("?x", THING), Variable("?y", THING)
ON, CLEAR, DONE = predicate("On", THING, THING), predicate("Clear", THING), predicate("Done")
A, B, C = Object("a", THING), Object("b", THING), Object("c", THING)
NOOP = Skill("Act", ())
Lifted = frozenset[LiftedAtom]


def operator(parameters: tuple[Variable, ...], pre: Lifted, add: Lifted, delete: Lifted = frozenset()) -> Operator:
    return Operator("Op", parameters, pre, add, delete, NOOP, ())


def lifted(*atoms: LiftedAtom) -> Lifted:
    return frozenset(atoms)


def bound(task: GroundTask) -> list[str]:
    return [" ".join(o.name for o in objects) for _, objects in task.instances]


def test_hand_worked_stack() -> None:
    stack = operator(
        (X, Y), lifted(LiftedAtom(CLEAR, (X,)), LiftedAtom(CLEAR, (Y,))), lifted(LiftedAtom(ON, (X, Y))),
        lifted(LiftedAtom(CLEAR, (Y,))),
    )  # fmt: skip
    task = ground([stack], [C, B, A], frozenset({CLEAR(A), CLEAR(B)}), [ON(A, B)])
    assert bound(task) == ["a b", "b a"]
    assert [str(a) for a in task.atoms] == ["Clear(a)", "Clear(b)", "On(a, b)", "On(b, a)"]
    assert task.strips.pre == (0b0011, 0b0011)
    assert task.strips.add == (0b0100, 0b1000)
    assert task.strips.delete == (0b0010, 0b0001)
    assert (task.strips.initial, task.strips.goal, task.goal_reachable) == (0b0011, 0b0100, True)


def test_chained_reachability_needs_later_facts_joined_with_earlier_ones() -> None:
    move = operator((X, Y), lifted(LiftedAtom(CLEAR, (X,)), LiftedAtom(ON, (X, Y))), lifted(LiftedAtom(CLEAR, (Y,))))
    task = ground([move], [A, B, C], frozenset({CLEAR(A), ON(B, C), ON(A, B), ON(C, C)}), [CLEAR(C)])
    assert bound(task) == ["a b", "b c"]
    assert task.goal_reachable


@pytest.mark.parametrize(("distinct", "expected"), [(True, ["a b", "b a"]), (False, ["a a", "a b", "b a", "b b"])])
def test_repeated_objects_only_when_asked(distinct: bool, expected: list[str]) -> None:
    free = operator((X, Y), frozenset(), lifted(LiftedAtom(ON, (X, Y))))
    assert bound(ground([free], [A, B], frozenset(), [], distinct=distinct)) == expected


def test_a_variable_repeated_in_one_precondition_binds_once() -> None:
    loop = operator((X,), lifted(LiftedAtom(ON, (X, X))), lifted(LiftedAtom(CLEAR, (X,))))
    assert bound(ground([loop], [A, B], frozenset({ON(A, B), ON(B, B)}), [])) == ["b"]


def test_no_arguments_no_parameters_no_preconditions() -> None:
    start = operator((), frozenset(), lifted(LiftedAtom(DONE, ())))
    then = operator((X,), lifted(LiftedAtom(DONE, ())), lifted(LiftedAtom(CLEAR, (X,))))
    task = ground([then, start], [A, B], frozenset(), [CLEAR(B), DONE()])
    assert bound(task) == ["a", "b", ""]
    assert task.goal_reachable
    assert ground([], [], frozenset(), []).strips.facts == 0


def test_supertypes_match_their_subtypes_only() -> None:
    ball, red, box = Object("ball", BALL), Object("red", RED_BALL), Object("box", BOX)
    hot = predicate("Hot", THING)
    heat = operator((v := Variable("?b", BALL),), frozenset(), lifted(LiftedAtom(hot, (v,))))
    assert bound(ground([heat], [ball, red, box], frozenset(), [])) == ["ball", "red"]


def test_unreachable_goal_is_told_apart_from_an_empty_one() -> None:
    assert not ground([], [A], frozenset(), [CLEAR(A)]).goal_reachable
    assert ground([], [A], frozenset(), []).goal_reachable


def test_budget_counts_instances_exactly() -> None:
    free = operator((X, Y), frozenset(), lifted(LiftedAtom(ON, (X, Y))))
    assert len(ground([free], [A, B, C], frozenset(), [], budget=6).instances) == 6
    with pytest.raises(GroundingBudgetError, match="more than 5 ground operators"):
        ground([free], [A, B, C], frozenset(), [], budget=5)


def test_hostile_eight_parameters_join_without_enumerating_all_tuples() -> None:
    objects = [Object(f"o{i:02}", THING) for i in range(30)]
    variables = tuple(Variable(f"?x{i}", THING) for i in range(8))
    chain = lifted(*(LiftedAtom(ON, (variables[i], variables[i + 1])) for i in range(7)))
    walk = operator(variables, chain, lifted(LiftedAtom(CLEAR, (variables[7],))))
    facts = frozenset(ON(objects[i], objects[i + 1]) for i in range(29))
    assert len(ground([walk], objects, facts, []).instances) == 23  # 30**8 tuples


def test_hostile_forty_distinct_parameters_are_refused_or_end_at_a_budget_that_is_named() -> None:
    many = operator(tuple(Variable(f"?x{i}", BALL) for i in range(40)), frozenset(), frozenset())
    assert not ground([many], [Object(f"b{i}", BALL) for i in range(39)], frozenset(), (), budget=50).instances
    clear = lifted(*(LiftedAtom(CLEAR, (v,)) for v in many.parameters))
    with pytest.raises(
        GroundingBudgetError, match="0 so far, takes more work than a budget of 50 allows; it has 40 par"
    ):
        objects = [Object(f"b{i}", BALL) for i in range(60)]
        ground([operator(many.parameters, clear, frozenset())], objects, frozenset(map(CLEAR, objects)), (), budget=50)


def test_hostile_a_task_whose_bits_would_fill_the_memory_is_refused_before_they_are_made() -> None:
    check_size(1_000, 10_000)
    with pytest.raises(GroundingBudgetError, match="50000 ground operators over 100000 facts would take"):
        check_size(100_000, 50_000)


@given(st.integers(0, 2**32), st.booleans())
@settings(max_examples=300, deadline=None)
def test_equals_naive_enumeration(seed: int, distinct: bool) -> None:
    operators, objects, initial, goal = random_lifted(seed)
    task = ground(operators, objects, initial, goal, distinct=distinct)
    instances, reached, used = naive_ground(operators, objects, initial, distinct)
    assert len(task.instances) == len(used)
    assert {(op.name, bound) for op, bound in task.instances} == instances
    assert set(task.atoms) == reached
    assert len(task.atoms) == len(reached)
    assert task.goal_reachable == (set(goal) <= reached)
    naive: set[tuple[object, ...]] = {
        (g.operator.name, g.objects, g.preconditions, g.add, g.delete & reached) for g in used
    }
    wanted: set[Atom] = set(goal) & reached
    assert named(task) == naive | {("initial", initial), ("goal", frozenset(wanted), task.goal_reachable)}


@given(st.integers(0, 2**32))
@settings(max_examples=100, deadline=None)
def test_order_of_objects_operators_and_goal_does_not_matter(seed: int) -> None:
    operators, objects, initial, goal = random_lifted(seed)
    task = ground(operators, objects, initial, goal)
    rng = Random(seed)
    shuffled = ground(operators, rng.sample(objects, len(objects)), initial, rng.sample(goal, len(goal)))
    assert shuffled == task
    reordered = ground(rng.sample(operators, len(operators)), objects, initial, goal)
    assert reordered.atoms == task.atoms
    assert named(reordered) == named(task)
