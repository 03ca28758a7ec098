"""``demo``: the whole method in one command, without a key."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from pix2pred.api import load_solver
from pix2pred.cli.console import UsageError, err, out, print_json, print_solved
from pix2pred.cli.data import generate
from pix2pred.cli.estimating import project_settings
from pix2pred.cli.learn import ModelToAsk, run_learning
from pix2pred.cli.ranges import NOT_NEGATIVE, POSITIVE, output_folder
from pix2pred.cli.solve import run_solving
from pix2pred.demos import read_project, read_tasks
from pix2pred.recordings import Recording, load_recording
from pix2pred.registry import Registry
from pix2pred.report import write_report
from pix2pred.runs.folder import RunFolder
from pix2pred.settings import of_file
from pix2pred.structs.environment import SimulatedTask

READER_FAMILY, RECORDED_FAMILY = "more-stacks", "combo"
"""What is shown when no family is named, by the offline reader and by the recorded model."""


@dataclass(frozen=True, slots=True)
class _Shown:
    """What a demonstration runs on: the folder it works in, where answers come from, and which tasks it solves."""

    base: Path
    domain: str
    family: str
    seed: int
    vlm: str
    config: Path | None
    tasks: int


def demo(
    *,
    family: Annotated[
        str | None,
        Parameter(help="more-stacks, bigger or combo [default: more-stacks]; recorded: combo, kitchen or coffee."),
    ] = None,
    seed: Annotated[int, Parameter(help="Varies demonstrations and tasks.", validator=NOT_NEGATIVE)] = 0,
    count: Annotated[int, Parameter(help="Unseen tasks to solve.", validator=POSITIVE)] = 10,
    recorded: Annotated[bool, Parameter(help="Replay a large model's own answers instead of the reader.")] = False,
    out_dir: Annotated[Path, Parameter(name="--out", help="Folder for data and run.", validator=output_folder)] = Path(
        "runs/demo"
    ),
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Learn a world model from demonstrations and solve unseen tasks, without key or network.

    By default burger demonstrations are drawn and the offline reader labels them. With --recorded the answers of a
    large vision-language model, which are shipped with the program, are replayed on the pictures it was shown.

    For example:

    - `pix2pred demo --family bigger`
    - `pix2pred demo --recorded`
    """
    recording: Recording | None = None
    if recorded:
        recording = load_recording(family or RECORDED_FAMILY)
        shown = _recorded(registry, recording, out_dir, min(count, recording.about.tasks))
    else:
        shown = _read(registry, family or READER_FAMILY, seed, out_dir, count)
    metrics, summary, report = _learn_and_solve(registry, shown, recording, quiet=json)
    run = shown.base / "run"
    if json:
        print_json({"run": str(run), "learn": metrics, "solve": summary})
    else:
        print_solved(summary)
        out.print(f"run folder: {run}", markup=False)
        out.print(f"report: {report}", markup=False)
    return 0 if summary["solved"] == summary["tasks"] else 1


def _read(registry: Registry, family: str, seed: int, out_dir: Path, count: int) -> _Shown:
    base = out_dir / f"burger-{family}-seed{seed}"
    if not (base / "data" / "domain.yaml").exists():
        generate("burger", family=family, seed=seed, tasks=count, out=base / "data", json=False, registry=registry)
    return _Shown(base, "burger", family, seed, "offline", None, count)


def _recorded(registry: Registry, recording: Recording, out_dir: Path, count: int) -> _Shown:
    about, base = recording.about, out_dir / f"recorded-{recording.name}"
    recording.unpack_answers(base / "answers")
    if not (base / "data" / "domain.yaml").exists():
        if recording.brings_data:
            recording.unpack_data(base / "data")
        else:
            generate(
                about.domain,
                family=about.family,
                seed=about.seed,
                tasks=about.tasks,
                out=base / "data",
                registry=registry,
            )
    vlm = f"replay:{base / 'answers'}"
    return _Shown(base, about.domain, about.family, about.seed, vlm, recording.settings, count)


def _say_what_it_proves(recording: Recording | None) -> None:
    if recording is None:
        err.print("The offline reader is a set of small classifiers trained on pictures of this domain, not a VLM.")
        return
    about = recording.about
    err.print(f"Replayed: {about.model} ({about.recorded}). Nothing is asked.", markup=False)
    for title, sentences in (("It shows:", about.shows), ("It does not show more:", about.does_not_show)):
        err.print(title, *(f"  {' '.join(sentence.split())}" for sentence in sentences), sep="\n", markup=False)


def _learn_and_solve(
    registry: Registry, shown: _Shown, recording: Recording | None, *, quiet: bool
) -> tuple[dict[str, Any], dict[str, Any], Path]:
    """The summaries of learning and of solving, and where the report lies."""
    data, run = shown.base / "data", shown.base / "run"
    project = read_project(data)
    stored = read_tasks(data, project.vocabulary)[: shown.tasks]
    if len(stored) < shown.tasks:
        raise UsageError(f"{data}: holds {len(stored)} tasks; for {shown.tasks} choose another --out or delete it")
    _say_what_it_proves(recording)
    tasks = [SimulatedTask(s.task, s.simulator or {}) for s in stored]
    settings = project_settings(project, *([of_file(shown.config)] if shown.config else []))
    metrics = run_learning(registry, project, settings, ModelToAsk(shown.vlm), run, quiet=quiet)
    with RunFolder(run).locked() as folder:
        solver, _ = load_solver(folder, "portfolio", registry=registry)
        summary = run_solving(
            registry, folder, f"{shown.domain}-{shown.family}-seed{shown.seed}", tasks, solver, shown.domain
        )
        report = write_report(folder)
    return metrics, summary, report
