"""Planning for PDDL problems with searches of ours."""

from __future__ import annotations

import time
from dataclasses import dataclass

from pix2pred.planning.instances import GroundingBudgetError
from pix2pred.planning.pddl.compiling.ground import ground_pddl
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem
from pix2pred.planning.pddl.steps import PddlStep
from pix2pred.planning.planner import Planner
from pix2pred.structs import PlanStatus
from pix2pred.system.garbage import seldom_collected


@dataclass(frozen=True, slots=True)
class PddlPlan:
    """The outcome of planning; ``nodes`` counts created search nodes (``None``: an external planner does not tell).

    ``seconds`` is wall time and decides nothing. ``why`` says which budget did not suffice for grounding.
    """

    status: PlanStatus
    steps: tuple[PddlStep, ...]
    nodes: int | None
    seconds: float
    why: str = ""


@seldom_collected()
def solve_pddl(domain: PddlDomain, problem: PddlProblem, planner: Planner) -> PddlPlan:
    """Look for a plan with a search of ours. More ground operators than ``planner`` allows are the status BUDGET."""
    start = time.perf_counter()
    try:
        task = ground_pddl(domain, problem, planner.max_operators)
    except GroundingBudgetError as error:
        return PddlPlan(PlanStatus.BUDGET, (), 0, time.perf_counter() - start, str(error))
    if not task.goal_reachable:
        return PddlPlan(PlanStatus.UNSOLVABLE, (), 0, time.perf_counter() - start)
    found = planner.search(task.strips)
    steps = tuple(task.steps[k] for k in found.plan)
    return PddlPlan(found.status, steps, found.nodes, time.perf_counter() - start)
