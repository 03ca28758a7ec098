"""``solve``: unseen tasks with a learned world model."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from pix2pred.api import load_solver
from pix2pred.cli.console import UsageError, bars, out, print_json, print_solved
from pix2pred.cli.learn import say_where_questions_wait
from pix2pred.cli.ranges import NOT_NEGATIVE, POSITIVE, SHARE, output_file
from pix2pred.demos import FolderError, Problem, read_tasks
from pix2pred.execution import Solver, TruthOf
from pix2pred.execution.film import Film
from pix2pred.registry import Registry, check_family
from pix2pred.report import write_report
from pix2pred.runs import addresses
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.solve import solve_into
from pix2pred.structs import PlanStatus
from pix2pred.structs.environment import Environment, SimulatedTask
from pix2pred.vlm.distilled.tally import Tallied


# Longer than others: every option is a line, with its help.
def solve(
    run: Annotated[Path, Parameter(help="Run folder, as made by learn.")],
    /,
    *,
    tasks: Annotated[Path | None, Parameter(help="Project folder whose tasks to solve, instead of new ones.")] = None,
    domain: Annotated[str | None, Parameter(help="Domain of new tasks [default: the run's].")] = None,
    family: Annotated[str | None, Parameter(help="Family of new tasks [default: the run's].")] = None,
    seed: Annotated[int, Parameter(help="Varies the new tasks.", validator=NOT_NEGATIVE)] = 0,
    count: Annotated[int, Parameter(help="Number of new tasks.", validator=POSITIVE)] = 10,
    vlm: Annotated[
        str | None, Parameter(help="What looks at the tasks [default: the model that labelled the demonstrations].")
    ] = None,
    planner: Annotated[
        str, Parameter(help="portfolio, astar-lmcut, gbfs-ff, or an engine of the extra 'planners'.")
    ] = "portfolio",
    closed_loop: Annotated[bool, Parameter(help="Look after every skill and plan again when needed.")] = False,
    ask_again: Annotated[
        int | None,
        Parameter(
            help="Atoms that may be asked about again in one look, when in doubt [default: 4; open loop: 0].",
            validator=NOT_NEGATIVE,
        ),
    ] = None,
    disturb: Annotated[
        float, Parameter(help="Probability that the scene is disturbed after a skill.", validator=SHARE)
    ] = 0.0,
    video: Annotated[
        Path | None, Parameter(help="MP4 file to film the episodes into (extra: video).", validator=output_file)
    ] = None,
    plan_only: Annotated[bool, Parameter(help="Label and plan; execute nothing, need no simulator.")] = False,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Solve unseen tasks in the simulator with the world model of a run folder.

    For example:

    - `pix2pred solve runs/stacks --domain burger --family more-stacks --seed 1 --count 10`

    - `pix2pred solve runs/tea --tasks data/tea --vlm openai:gpt-4o-mini`
    """
    RunFolder(run).config()
    with RunFolder(run).locked() as folder:
        solver, config = load_solver(
            folder, planner, closed_loop=closed_loop, ask_again=ask_again, vlm=vlm, registry=registry
        )
        domain = domain or config["simulator"].get("domain")
        family = family or config["simulator"].get("family")
        chosen, name = _tasks(registry, tasks, solver, domain, family, seed, count, plan_only=plan_only)
        waiting = registry.model_spec(vlm or addresses.reached(config["vlm"], run))
        if plan_only:
            say_where_questions_wait(waiting)
            return _plan(folder, name, chosen, solver, as_json=json)
        if domain is None:
            raise UsageError(f"{run}: no simulator is known for these tasks; name one with --domain, or --plan-only")
        say_where_questions_wait(waiting)
        if vlm:
            name += "-" + re.sub(r"[^A-Za-z0-9]+", "-", solver.labeller.vlm.name).strip("-")
        if closed_loop or disturb:
            name += ("-closed-loop" if closed_loop else "") + (f"-disturb-{disturb:g}" if disturb else "")
        summary = run_solving(registry, folder, name, chosen, solver, domain, disturb, video)
        write_report(folder)
    if json:
        print_json(summary)
    else:
        print_solved(summary)
        if isinstance(solver.labeller.vlm, Tallied):
            out.print(solver.labeller.vlm.tally.line(), markup=False, soft_wrap=True)
    return 0 if summary["solved"] == summary["tasks"] else 1


def run_solving(
    registry: Registry,
    folder: RunFolder,
    name: str,
    tasks: Sequence[SimulatedTask],
    solver: Solver,
    domain: str,
    disturb: float = 0.0,
    video: Path | None = None,
) -> dict[str, Any]:
    """Solve with progress bars; gives the summary. The episodes are filmed into ``video``."""
    made = registry.domain(domain)

    def environment_for(task: SimulatedTask) -> tuple[Environment, TruthOf | None]:
        try:
            environment = made.environment(task.task, task.simulator, disturb)
        except ValueError as error:
            raise UsageError(f"task {task.task.name}: simulator.json: {error}; --plan-only needs none") from error
        return environment, None if disturb else registry.truth(made, environment)

    for task in tasks:
        environment_for(task)  # before anything is asked or executed
    with bars() as progress, Film(video) if video else nullcontext() as film:
        solved = solve_into(folder, name, tasks, solver, environment_for, progress, film)
    return solved.as_dict()


def _tasks(
    registry: Registry,
    directory: Path | None,
    solver: Solver,
    domain: str | None,
    family: str | None,
    seed: int,
    count: int,
    *,
    plan_only: bool,
) -> tuple[list[SimulatedTask], str]:
    """The tasks asked for and a name for the results."""
    if directory is None:
        if domain is None or family is None:
            raise UsageError("name the tasks: --tasks DIR, or --domain and --family of a simulator")
        made = registry.domain(domain)
        check_family(made, family)
        return list(made.tasks(family, seed, count)), f"{domain}-{family}-seed{seed}"
    stored = read_tasks(directory, solver.model.vocabulary)
    lacking = [
        Problem(s.simulator_path, None, "is missing; --plan-only plans without") for s in stored if not s.simulator
    ]
    if not stored:
        raise FolderError.about(directory / "tasks", "holds no task")
    if lacking and not plan_only:
        raise FolderError(lacking)
    return [SimulatedTask(s.task, s.simulator or {}) for s in stored], directory.resolve().name


def _plan(folder: RunFolder, name: str, tasks: Sequence[SimulatedTask], solver: Solver, *, as_json: bool) -> int:
    plans = []
    for task in tasks:
        _, result = solver.plan(task.task)
        plans.append({"task": task.task.name, "status": result.status, "plan": [str(step) for step in result.plan]})
    folder.write_json(f"plans/{name}.json", plans)
    if as_json:
        print_json({"plans": plans})
    else:
        for entry in plans:
            out.print(f"{entry['task']}: {entry['status']}, {len(entry['plan'])} skills", markup=False)
    return 0 if all(entry["status"] == PlanStatus.SOLVED for entry in plans) else 1
