"""``plan-pddl``: planning for its own sake."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, TypeVar

from cyclopts import Parameter

from pix2pred.cli.console import POSITIVE, print_json
from pix2pred.cli.console import out as console
from pix2pred.planning import is_valid
from pix2pred.planning.external.planner import ENGINES, IN_EXTRA, TIME_LIMIT
from pix2pred.planning.pddl.read import PddlDomain, read_domain, read_problem
from pix2pred.planning.pddl.syntax import PddlError
from pix2pred.registry import RegistryError, load_planner, planner_names
from pix2pred.structs import PlanResult, PlanStatus
from pix2pred.system.files import write_whole

T = TypeVar("T")
EXTERNAL = (
    "fast-downward[-opt], pyperplan[-opt] (others as packages: "
    + ", ".join(sorted(name for name, package in ENGINES.items() if package not in IN_EXTRA))
    + ")"
)


def plan_pddl(
    domain: Path,
    problem: Path,
    /,
    *,
    planner: Annotated[
        str, Parameter(help=f"{', '.join(planner_names())}; with the extra 'planners' {EXTERNAL}.")
    ] = "gbfs-ff",
    time_limit: Annotated[
        float, Parameter(help="Seconds an external planner may take; our own are bounded by nodes.", validator=POSITIVE)
    ] = TIME_LIMIT,
    out: Annotated[Path | None, Parameter(help="File for the plan, one (action arg ...) a line.")] = None,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Plan for a typed STRIPS PDDL problem, check the plan with independent code, and write it.

    Exit codes: 0 a plan was found, 1 none was found, 2 bad input.

    Examples: pix2pred plan-pddl domain.pddl problem.pddl --planner astar-lmcut --out plan.txt

    pix2pred plan-pddl domain.pddl problem.pddl --planner fast-downward --time-limit 60
    """
    read: PddlDomain = _parsed(domain, read_domain)
    task = _parsed(problem, lambda text: read_problem(text, read))
    made = load_planner(planner, distinct=read.distinct, time_limit=time_limit)
    found = made.plan(read.operators, task.objects, task.initial, task.goal)
    lines = [f"({' '.join((s.operator.name, *(o.name for o in s.objects)))})" for s in found.plan]
    if found.status == PlanStatus.SOLVED:
        assert is_valid(found.plan, task.initial, task.goal), "the planner returned a plan that does not work"
        if out is not None:
            write_whole(out, "".join(f"{line}\n" for line in lines).encode())
    if json:
        print_json({"status": found.status, "plan": lines, "nodes": found.nodes, "seconds": round(found.seconds, 4)})
    else:
        for line in lines:
            console.print(line, markup=False)
        console.print(_last_line(found))
    return 0 if found.status == PlanStatus.SOLVED else 1


def _last_line(found: PlanResult) -> str:
    """How the search ended, as a comment of the plan format."""
    if found.status == PlanStatus.TIMEOUT:
        return f"; stopped after {found.seconds:.0f} s without a plan; --time-limit allows more"
    nodes = "nodes unknown" if found.nodes is None else f"{found.nodes} nodes"
    return f"; {found.status}, {len(found.plan)} steps, {nodes}, {found.seconds:.3f} s"


def _parsed(path: Path, read: Callable[[str], T]) -> T:
    data = path.read_bytes()
    try:
        return read(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise RegistryError(f"{path}: line {line}: this is no UTF-8 text; save the file as UTF-8") from error
    except PddlError as error:
        raise RegistryError(f"{path}: {error}") from error
