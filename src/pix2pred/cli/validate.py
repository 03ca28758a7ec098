"""``validate``: what a plan does, step by step, and whether it reaches the goal."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pix2pred.cli.console import out as console
from pix2pred.cli.console import plain, print_json
from pix2pred.cli.pddl_files import parsed
from pix2pred.planning.pddl.check import CheckedStep, check_plan
from pix2pred.planning.pddl.read import PddlDomain, read_domain, read_problem
from pix2pred.planning.pddl.steps import read_plan


def validate(
    domain: Path,
    problem: Path,
    plan: Path,
    /,
    *,
    explain: Annotated[bool, Parameter(negative=(), help="Say what every step makes true and false.")] = False,
    json: Annotated[bool, Parameter(negative=(), help="Print one JSON object on the last line.")] = False,
) -> int:
    """Execute a plan for a PDDL problem and say whether it works, or what is missing at which step.

    The plan is a file with one (action object ...) a line, as plan-pddl and other planners write it.

    Exit codes: 0 the plan works, 1 it does not, 2 bad input.

    For example:

    - `pix2pred validate domain.pddl problem.pddl plan.txt --explain`
    """
    read: PddlDomain = parsed(domain, read_domain)
    task = parsed(problem, lambda text: read_problem(text, read))
    checked = check_plan(read, task, parsed(plan, lambda text: read_plan(text, read, task)))
    if json:
        print_json(checked.as_dict())
    else:
        for number, step in enumerate(checked.steps, start=1):
            if explain or step.unmet:
                _print_step(number, step)
        for missing in checked.unmet:
            _say(f"the goal is not reached: {missing}")
        count = len(checked.steps)
        _say(f"; {'valid' if checked.valid else 'invalid'}, {count} steps, cost {checked.cost}")
    return 0 if checked.valid else 1


def _print_step(number: int, step: CheckedStep) -> None:
    _say(f"{number} {step.step}")
    for missing in step.unmet:
        _say(f"    cannot be executed: {missing}")
    for sign, facts in (("+", step.added), ("-", step.removed)):
        for fact in facts:
            _say(f"    {sign} ({' '.join(fact)})")


def _say(text: str) -> None:
    console.print(plain(text), markup=False, soft_wrap=True)
