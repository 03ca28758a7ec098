"""``generate`` and ``check``: demonstrations on disk."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pix2pred.cli.console import NOT_NEGATIVE, bars, err, out, print_json
from pix2pred.demos import check_project, write_project
from pix2pred.registry import check_family, load_domain


def generate(
    domain: str,
    /,
    *,
    family: Annotated[str | None, Parameter(help="Family of demonstrations [default: the domain's first].")] = None,
    seed: Annotated[int, Parameter(help="Varies counts and positions.", validator=NOT_NEGATIVE)] = 0,
    tasks: Annotated[int, Parameter(help="Number of unseen test tasks to add.", validator=NOT_NEGATIVE)] = 10,
    out: Annotated[Path, Parameter(name="--out", help="Folder to write.")],
    overwrite: Annotated[bool, Parameter(help="Replace a project that is already there.")] = False,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Write demonstrations and test tasks of a simulated domain as a project folder.

    Example: pix2pred generate burger --family more-stacks --seed 0 --out data/stacks
    """
    made = load_domain(domain)
    family = family or made.families[0]
    check_family(made, family)
    with bars() as progress:
        progress("generate", 0, 2, "demonstrations")
        demos = made.demonstrations(family, seed)
        progress("generate", 1, 2, "tasks")
        unseen = made.tasks(family, seed, tasks)
        progress("generate", 2, 2, "")
    write_project(
        out,
        made.vocabulary(family),
        demos,
        unseen,
        {"domain": domain, "family": family},
        made.settings(family),
        overwrite=overwrite,
    )
    if json:
        print_json({"folder": str(out), "demonstrations": len(demos), "tasks": len(unseen)})
    else:
        err.print(f"{len(demos)} demonstrations and {len(unseen)} tasks in {out}", markup=False)
    return 0


def check(
    directory: Path,
    /,
    *,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Validate a project folder and report every problem with file and line.

    Example: pix2pred check data/stacks
    """
    problems = check_project(directory)
    if json:
        print_json({"problems": [{"file": str(p.file), "line": p.line, "message": p.message} for p in problems]})
    else:
        for problem in problems:
            out.print(str(problem), markup=False, soft_wrap=True)
        out.print("no problems found" if not problems else f"{len(problems)} problem(s)")
    return 2 if problems else 0
