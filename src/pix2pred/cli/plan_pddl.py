"""``plan-pddl``: planning for its own sake."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, TypeVar

from cyclopts import Parameter

from pix2pred.cli.console import out as console
from pix2pred.cli.console import print_json
from pix2pred.planning import is_valid
from pix2pred.planning.pddl_read import PddlDomain, read_domain, read_problem
from pix2pred.planning.pddl_syntax import PddlError
from pix2pred.registry import RegistryError, load_planner
from pix2pred.structs import PlanStatus
from pix2pred.structs.files import write_whole

T = TypeVar("T")


def plan_pddl(
    domain: Path,
    problem: Path,
    /,
    *,
    planner: Annotated[str, Parameter(help="gbfs-ff, astar-lmcut or portfolio.")] = "gbfs-ff",
    out: Annotated[Path | None, Parameter(help="File for the plan, one (action arg ...) a line.")] = None,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Plan for a typed STRIPS PDDL problem, check the plan with independent code, and write it.

    Example: pix2pred plan-pddl domain.pddl problem.pddl --planner astar-lmcut --out plan.txt
    """
    read: PddlDomain = _parsed(domain, read_domain)
    task = _parsed(problem, lambda text: read_problem(text, read))
    made = load_planner(planner, distinct=read.distinct)
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
        console.print(f"; {found.status}, {len(lines)} steps, {found.nodes} nodes, {found.seconds:.3f} s")
    return 0 if found.status == PlanStatus.SOLVED else 1


def _parsed(path: Path, read: Callable[[str], T]) -> T:
    try:
        return read(path.read_text(encoding="utf-8"))
    except (PddlError, UnicodeDecodeError) as error:
        raise RegistryError(f"{path}: {error}") from error
