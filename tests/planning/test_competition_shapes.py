"""Domains of the kinds that planning competitions made known: read, planned for, and checked by independent code."""

from __future__ import annotations

from itertools import count
from random import Random

import pytest

from pix2pred.planners import Planners
from pix2pred.planning import Planner
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.plans import PddlPlan, solve_pddl
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.structs import PlanStatus
from symbolic.problems import CATALOGUE, FOLDER


@pytest.mark.parametrize("name", list(CATALOGUE))
def test_drawn_problems_are_read_and_solved_and_no_plan_of_the_optimal_search_is_longer(name: str) -> None:
    domain = read_domain((FOLDER / f"{name}.pddl").read_text())
    rng = Random(name)
    lengths: list[tuple[int, int]] = []
    for number in count():
        text = CATALOGUE[name][0](rng, False).text(f"p{number}", name)
        problem = read_problem(text, domain)
        found: dict[str, PddlPlan] = {}
        for planner in ("quick", "astar-lmcut"):
            made = Planners().planner(planner, distinct=domain.distinct)
            assert isinstance(made, Planner)
            found[planner] = solve_pddl(domain, problem, made)
        quick, optimal = found["quick"], found["astar-lmcut"]
        assert quick.status == optimal.status
        if quick.status == PlanStatus.SOLVED and quick.steps:
            assert all(check_plan(domain, problem, plan.steps).valid for plan in found.values())
            lengths.append((len(quick.steps), len(optimal.steps)))
        if len(lengths) == 3:
            break
    assert all(optimal <= quick <= 1.5 * optimal for quick, optimal in lengths), lengths
