"""A*, greedy search, portfolios and planning from symbols, against breadth-first search."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import golden
from pix2pred.planning import AStar, GreedyBestFirst, Heuristic, Planner, Portfolio, SearchResult, Strips, is_valid
from pix2pred.structs import Atom, LiftedAtom, Object, Operator, PlanStatus, Skill, Variable
from planning.random_tasks import THING, naive_ground, predicate, random_lifted, random_strips, run, shortest

SEEDS = st.integers(0, 2**32)
SWITCHES = Strips(6, (0,) * 6, tuple(1 << i for i in range(6)), (0,) * 6, 0, 0b111111)


@given(SEEDS)
@settings(max_examples=400, deadline=None)
def test_a_star_is_optimal_and_greedy_search_complete(seed: int) -> None:
    task = random_strips(seed)
    length = shortest(task)
    for search in (AStar(), GreedyBestFirst()):
        found = search(task)
        assert found.status == (PlanStatus.UNSOLVABLE if length is None else PlanStatus.SOLVED)
        assert found.nodes >= 1
        if length is None:
            assert found.plan == ()
            continue
        final = run(task, found.plan)
        assert final is not None, "a step is not applicable"
        assert final & task.goal == task.goal
        assert len(found.plan) >= length
        if isinstance(search, AStar):
            assert len(found.plan) == length


@given(SEEDS)
@settings(max_examples=200, deadline=None)
def test_dropping_static_facts_keeps_every_plan(seed: int) -> None:
    task = random_strips(seed)
    simpler = task.without_static_facts()
    for length in range(3):
        for plan in product(range(len(task.pre)), repeat=length):
            full, reduced = run(task, plan), run(simpler, plan)
            assert (full is None) == (reduced is None)
            if full is not None and reduced is not None:
                assert (full & task.goal == task.goal) == (reduced & simpler.goal == simpler.goal)


def test_static_facts_leave_preconditions_and_goal() -> None:
    task = Strips(3, (0b011, 0b100), (0b100, 0b010), (0, 0), 0b001, 0b101)
    assert task.without_static_facts() == Strips(3, (0b010, 0b100), (0b100, 0b010), (0, 0), 0, 0b100)


@given(SEEDS, st.integers(1, 5))
@settings(max_examples=200, deadline=None)
def test_a_small_budget_never_turns_into_a_wrong_answer(seed: int, budget: int) -> None:
    task = random_strips(seed)
    length = shortest(task)
    for search in (AStar(max_nodes=budget), GreedyBestFirst(max_nodes=budget)):
        found = search(task)
        assert found.nodes <= budget
        if found.status == PlanStatus.SOLVED:
            assert run(task, found.plan) is not None
        elif found.status == PlanStatus.UNSOLVABLE:
            assert length is None
        else:
            assert found.plan == ()


def test_budget_is_reported_not_unsolvable() -> None:
    for search in (AStar(max_nodes=3), GreedyBestFirst(max_nodes=3)):
        assert search(SWITCHES) == SearchResult(PlanStatus.BUDGET, (), 3)
    assert AStar(max_nodes=1)(Strips(1, (), (), (), 1, 1)).status == PlanStatus.SOLVED


class Listed(Heuristic):
    """Estimates from a table."""

    def __init__(self, estimates: dict[int, int]) -> None:
        self._estimates = estimates

    def __call__(self, state: int) -> int | None:
        return self._estimates[state]


def test_re_opening_with_an_inconsistent_heuristic() -> None:
    # 0 -> 1 -> 2 -> 3 and a detour-free edge 0 -> 2 that a misleading (but admissible) estimate hides at first
    task = Strips(
        5,
        (0b00001, 0b00001, 0b00010, 0b00100, 0b01000),
        (0b00010, 0b00100, 0b00100, 0b01000, 0b10000),
        (0b00001, 0b00001, 0b00010, 0b00100, 0b01000),
        0b00001,
        0b10000,
    )
    estimates = {0b00001: 0, 0b00010: 0, 0b00100: 0, 0b01000: 1, 0b10000: 0}
    assert len(AStar(heuristic=lambda task: Listed(estimates))(task).plan) == 3


def test_a_portfolio_falls_back_only_when_a_budget_runs_out() -> None:
    starved, enough = AStar(max_nodes=2), GreedyBestFirst()
    both = Portfolio((starved, enough))(SWITCHES)
    assert both.status == PlanStatus.SOLVED
    assert both.nodes == 2 + enough(SWITCHES).nodes
    assert Portfolio((starved, starved))(SWITCHES) == SearchResult(PlanStatus.BUDGET, (), 4)
    assert Portfolio((AStar(), starved))(SWITCHES) == AStar()(SWITCHES)
    hopeless = Strips(1, (), (), (), 0, 1)

    def untouched(task: Strips) -> SearchResult:
        raise AssertionError("UNSOLVABLE is an answer, not a reason to search again")

    assert Portfolio((AStar(), untouched))(hopeless).status == PlanStatus.UNSOLVABLE
    assert Portfolio(())(hopeless).status == PlanStatus.BUDGET


@given(SEEDS, st.booleans())
@settings(max_examples=150, deadline=None)
def test_planning_from_symbols_is_valid_and_shortest(seed: int, distinct: bool) -> None:
    operators, objects, initial, goal = random_lifted(seed)
    found = Planner(AStar(), distinct=distinct).plan(operators, objects, initial, goal)
    _, _, used = naive_ground(operators, objects, initial, distinct)
    layer, seen, length = {initial}, {initial}, 0
    while layer and not any(set(goal) <= s for s in layer):
        layer = {g.apply(s) for s in layer for g in used if g.applicable(s)} - seen
        seen |= layer
        length += 1
        if len(seen) > 3000:
            return
    assert (found.status == PlanStatus.SOLVED) == bool(layer)
    if layer:
        assert len(found.plan) == length
        assert is_valid(found.plan, initial, goal)
    else:
        assert found.status == PlanStatus.UNSOLVABLE


X = Variable("?x", THING)
LIT, SEEN = predicate("Lit", THING), predicate("Seen", THING)
LAMP = Object("lamp", THING)


def _operator(pre: list[Atom], add: list[Atom], delete: list[Atom]) -> Operator:
    def lift(atoms: list[Atom]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(a.predicate, (X,)) for a in atoms)

    return Operator("Op0", (X,), lift(pre), lift(add), lift(delete), Skill("Act", (THING,)), (X,))


def test_is_valid_rejects_illegal_plans() -> None:
    switch = _operator([], [LIT(LAMP)], [SEEN(LAMP)]).ground((LAMP,))
    look = _operator([LIT(LAMP)], [SEEN(LAMP)], [LIT(LAMP)]).ground((LAMP,))
    nothing: frozenset[Atom] = frozenset()
    assert is_valid([switch, look], nothing, [SEEN(LAMP)])
    assert not is_valid([look], nothing, [SEEN(LAMP)])  # precondition never held
    assert not is_valid([switch, look, look], nothing, [SEEN(LAMP)])  # deleted by the step before
    assert not is_valid([switch, look, switch], nothing, [SEEN(LAMP)])  # goal undone at the end
    assert not is_valid([switch], nothing, [SEEN(LAMP)])
    assert not is_valid([], nothing, [LIT(LAMP)])
    assert is_valid([], nothing, [])


def test_adding_wins_over_deleting_the_same_atom() -> None:
    both = _operator([], [LIT(LAMP)], [LIT(LAMP)])
    found = Planner(AStar()).plan([both], [LAMP], frozenset(), [LIT(LAMP)])
    assert found.status == PlanStatus.SOLVED
    assert is_valid(found.plan, frozenset(), [LIT(LAMP)])


def test_the_three_ways_not_to_find_a_plan() -> None:
    switch = _operator([], [LIT(LAMP)], [])
    noop = _operator([LIT(LAMP)], [], [])
    assert Planner(AStar()).plan([switch], [LAMP], frozenset(), [SEEN(LAMP)]).status == PlanStatus.UNSOLVABLE
    assert Planner(AStar(max_nodes=1)).plan([switch], [LAMP], frozenset(), [LIT(LAMP)]).status == PlanStatus.BUDGET
    two = [LAMP, Object("torch", THING)]
    assert Planner(AStar(), max_operators=1).plan([switch], two, frozenset(), []).status == PlanStatus.BUDGET
    assert Planner(AStar(), max_operators=1).plan([noop], two, frozenset(), []).status == PlanStatus.SOLVED


@pytest.mark.parametrize("search", [AStar(), GreedyBestFirst()])
def test_a_goal_that_holds_needs_no_step(search: AStar | GreedyBestFirst) -> None:
    found = Planner(search).plan(golden.load_operators("kitchen"), [], frozenset(), [])
    assert (found.status, found.plan) == (PlanStatus.SOLVED, ())
