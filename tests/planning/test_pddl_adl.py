"""All of the PDDL that is read, against breadth-first search over all tuples of objects."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.planning import AStar, GreedyBestFirst, Planner
from pix2pred.planning.heuristics.lmcut_costs import landmark_cut
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.plans import solve_pddl
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.structs import PlanStatus
from planning.random_pddl import cheapest, random_texts


@given(st.integers(0, 2**32))
@settings(max_examples=150, deadline=None)
def test_plans_are_found_where_there_are_any_and_the_optimal_planner_s_are_cheapest(seed: int) -> None:
    domain_text, problem_text = random_texts(seed)
    domain = read_domain(domain_text)
    problem = read_problem(problem_text, domain)
    cost = cheapest(domain, problem)
    if cost == -1:
        return
    for search in (AStar(landmark_cut), GreedyBestFirst()):
        found = solve_pddl(domain, problem, Planner(search))
        assert found.status == (PlanStatus.UNSOLVABLE if cost is None else PlanStatus.SOLVED), (found, cost)
        if found.status == PlanStatus.SOLVED:
            checked = check_plan(domain, problem, found.steps)
            assert checked.valid, checked
            spent = checked.cost if problem.minimise_costs else len(found.steps)
            assert spent == cost if isinstance(search, AStar) else spent >= (cost or 0)
