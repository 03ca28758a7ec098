"""Engines of others for PDDL problems: as numbers where the actions are STRIPS, as PDDL files where they are more."""

from __future__ import annotations

import time
from dataclasses import dataclass

from pix2pred.planning.external.planner import ExternalPlanner, ExternalPlannerError
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.plans import PddlPlan
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem
from pix2pred.planning.pddl.steps import PddlStep, read_plan
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class Sources:
    """The texts of a domain and of a problem."""

    domain: str
    problem: str


def solve_externally(domain: PddlDomain, problem: PddlProblem, sources: Sources, planner: ExternalPlanner) -> PddlPlan:
    """Look for a plan. Raises ``ExternalPlannerError``, also for a plan that does not work."""
    start = time.perf_counter()
    if domain.is_strips and problem.has_atomic_goal and not problem.minimise_costs:
        found = planner.plan(domain.operators, problem.objects, problem.initial, problem.goal)
        steps = tuple(PddlStep(s.operator.name, tuple(o.name for o in s.objects)) for s in found.plan)
        return PddlPlan(found.status, steps, None, found.seconds)
    status, lines = planner.plan_text(sources.domain, sources.problem)
    steps = read_plan("\n".join(lines), domain, problem)
    if status == PlanStatus.SOLVED and not check_plan(domain, problem, steps).valid:
        raise ExternalPlannerError(f"planner {planner.engine} gave a plan that does not work")
    return PddlPlan(status, steps, None, time.perf_counter() - start)
