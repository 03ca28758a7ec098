"""``demo``: the whole method in one command, without a key."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pix2pred.api import load_solver
from pix2pred.cli.console import NOT_NEGATIVE, POSITIVE, err, out, print_json, print_solved
from pix2pred.cli.data import generate
from pix2pred.cli.learn import resolve_settings, run_learning
from pix2pred.cli.solve import run_solving
from pix2pred.demos import read_project, read_tasks
from pix2pred.registry import RegistryError
from pix2pred.report import write_report
from pix2pred.runs.folder import RunFolder
from pix2pred.structs.environment import SimulatedTask
from pix2pred.vlm import StoreMode


def demo(
    *,
    family: Annotated[str, Parameter(help="more-stacks, bigger or combo.")] = "more-stacks",
    seed: Annotated[int, Parameter(validator=NOT_NEGATIVE)] = 0,
    count: Annotated[int, Parameter(help="Unseen tasks to solve.", validator=POSITIVE)] = 10,
    out_dir: Annotated[Path, Parameter(name="--out", help="Folder for data and run.")] = Path("runs/demo"),
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Draw burger demonstrations, learn a world model with the offline reader, and solve unseen tasks.

    Example: pix2pred demo --family more-stacks
    """
    base = out_dir / f"burger-{family}-seed{seed}"
    data, run = base / "data", base / "run"
    if not (data / "domain.yaml").exists():
        generate("burger", family=family, seed=seed, tasks=count, out=data, json=False)
    project = read_project(data)
    err.print("The offline reader is a set of small classifiers trained on pictures of this domain, not a VLM.")
    metrics = run_learning(project, resolve_settings(project, None), "offline", run, None, StoreMode.RESUME, quiet=json)
    with RunFolder(run).locked() as folder:
        solver, _ = load_solver(folder, "portfolio")
        stored = read_tasks(data, solver.model.vocabulary)[:count]
        if len(stored) < count:
            raise RegistryError(f"{data}: holds {len(stored)} tasks; for {count} choose another --out or delete it")
        tasks = [SimulatedTask(s.task, s.simulator or {}) for s in stored]
        summary = run_solving(folder, f"burger-{family}-seed{seed}", tasks, solver, "burger")
        report = write_report(folder)
    if json:
        print_json({"run": str(run), "learn": metrics, "solve": summary})
    else:
        print_solved(summary)
        out.print(f"run folder: {run}", markup=False)
        out.print(f"report: {report}", markup=False)
    return 0 if summary["solved"] == summary["tasks"] else 1
