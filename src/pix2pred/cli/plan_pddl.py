"""``plan-pddl``: planning for its own sake."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pix2pred.cli.console import out as console
from pix2pred.cli.console import print_json
from pix2pred.cli.pddl_files import parsed, text_of
from pix2pred.cli.ranges import between, output_file
from pix2pred.planners import Planners
from pix2pred.planning import ExternalPlanner, Planner, TaskPlanner
from pix2pred.planning.external.pddl import Sources, solve_externally
from pix2pred.planning.external.planner import ENGINES, IN_EXTRA, TIME_LIMIT
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.plans import PddlPlan, solve_pddl
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem, read_domain, read_problem
from pix2pred.structs import PlanStatus
from pix2pred.system.files import write_whole

EXTERNAL = (
    "fast-downward[-opt], pyperplan[-opt] (others as packages: "
    + ", ".join(sorted(name for name, package in ENGINES.items() if package not in IN_EXTRA))
    + ")"
)


def plan_pddl(
    domain: Annotated[Path, Parameter(help="PDDL domain.")],
    problem: Annotated[Path, Parameter(help="PDDL problem.")],
    /,
    *,
    planner: Annotated[
        str, Parameter(help=f"{', '.join(Planners().planner_names())}; with the extra 'planners' {EXTERNAL}.")
    ] = "quick",
    time_limit: Annotated[
        float,
        Parameter(
            help="Seconds an external planner may take; our own are bounded by nodes.", validator=between(1, 31_536_000)
        ),
    ] = TIME_LIMIT,
    out: Annotated[
        Path | None, Parameter(help="File for the plan, one (action arg ...) a line.", validator=output_file)
    ] = None,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    planners: Annotated[Planners, Parameter(parse=False)],
) -> int:
    """Plan for a PDDL problem, check the plan with independent code, and write it.

    Exit codes: 0 a plan was found, 1 none was found, 2 bad input.

    For example:

    - `pix2pred plan-pddl domain.pddl problem.pddl --planner astar-lmcut --out plan.txt`
    - `pix2pred plan-pddl domain.pddl problem.pddl --planner fast-downward --time-limit 60`
    """
    read: PddlDomain = parsed(domain, read_domain)
    task = parsed(problem, lambda text: read_problem(text, read))
    made = planners.planner(planner, distinct=read.distinct, time_limit=time_limit)
    found = _planned(made, read, task, Sources(text_of(domain), text_of(problem)))
    checked = check_plan(read, task, found.steps)
    lines = [str(step) for step in found.steps]
    if found.status == PlanStatus.SOLVED:
        assert checked.valid, "the planner returned a plan that does not work"
        if out is not None:
            write_whole(out, "".join(f"{line}\n" for line in lines).encode())
    cost = checked.cost if found.status == PlanStatus.SOLVED and any(a.costs for a in read.actions) else None
    if json:
        document = {"status": found.status, "plan": lines, "nodes": found.nodes, "seconds": round(found.seconds, 4)}
        print_json(document | ({} if cost is None else {"cost": cost}) | ({"why": found.why} if found.why else {}))
    else:
        for line in lines:
            console.print(line, markup=False)
        console.print(_last_line(found, cost, asked=task.minimise_costs))
    return 0 if found.status == PlanStatus.SOLVED else 1


def _planned(planner: TaskPlanner, domain: PddlDomain, problem: PddlProblem, sources: Sources) -> PddlPlan:
    """The plan of a search of ours, or of an engine of others, which reads what it can."""
    if isinstance(planner, Planner):
        return solve_pddl(domain, problem, planner)
    assert isinstance(planner, ExternalPlanner), "there are two kinds of planners"
    return solve_externally(domain, problem, sources, planner)


def _last_line(found: PddlPlan, cost: int | None, *, asked: bool) -> str:
    """How the search ended, as a comment of the plan format."""
    if found.status == PlanStatus.TIMEOUT:
        return f"; stopped after {found.seconds:.0f} s without a plan; --time-limit allows more"
    if found.why:
        return f"; {found.status} before the search: {found.why}"
    nodes = "nodes unknown" if found.nodes is None else f"{found.nodes} nodes"
    costs = "" if cost is None else f"cost {cost}, " if asked else f"cost {cost} (no :metric asks for a small one), "
    return f"; {found.status}, {len(found.steps)} steps, {costs}{nodes}, {found.seconds:.3f} s"
