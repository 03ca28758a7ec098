"""Running a suite: jobs in parallel, every finished try kept, the rows put together in the order of the suite."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pix2pred.benchmark.cells import Catalogue, Done, Job, run_job
from pix2pred.benchmark.rows import Row, dump_csv, dump_rows
from pix2pred.benchmark.suite import Suite
from pix2pred.benchmark.sweeps import NotAvailableError
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.system.parallel import Workers
from pix2pred.system.progress import Progress, Stage, silent
from pix2pred.vlm import AnswerStore, StoreMode

ROWS = "rows.jsonl"


@dataclass(frozen=True, slots=True)
class Run:
    """A benchmark run as its ``folder`` holds it now.

    ``vlm`` names the model that is asked; ``rows`` are the tries so far, and ``learned`` what each cell learned.
    """

    folder: Path
    suite: Suite
    vlm: str
    rows: tuple[Row, ...]
    learned: dict[str, dict[str, Any]]
    """What was learned, by cell: ``family[/value]/seed<k>/approach``."""


def run_suite(
    folder: Path,
    suite: Suite,
    catalogue: Catalogue,
    *,
    vlm: str,
    workers: Workers,
    answers: Path | None = None,
    mode: StoreMode = StoreMode.RESUME,
    progress: Progress = silent,
    warn: Callable[[str], None] = lambda sentence: None,
) -> Run:
    """Run what is missing of ``suite`` in ``folder``, and write ``rows.jsonl`` and ``rows.csv``.

    What cannot be run here is said before anything else is; ``warn`` gets one sentence for each reason.

    The rows depend on suite, model and answers alone: not on workers, on their number, or on interruptions.
    """
    store = AnswerStore(answers or folder)
    store.check()
    with RunFolder(folder).locked() as run:
        run.claim(_config(suite, vlm))
        jobs = _jobs(folder, suite, catalogue, vlm, store.directory, mode)
        for reason, families in _not_available(jobs).items():
            warn(f"left out here: {', '.join(families)}: {reason}; the same command adds what was left out")
        done: list[Done] = []
        progress(Stage.BENCH, 0, len(jobs), "")
        for one in workers.map(run_job, jobs):
            done.append(one)
            progress(Stage.BENCH, len(done), len(jobs), one.place.removeprefix("cells/"))
        rows = tuple(row for job in jobs for row in job.rows())
        run.write(ROWS, dump_rows(rows))
        run.write("rows.csv", dump_csv(rows))
        timings = {d.place.removeprefix("cells/"): {"seconds": d.seconds, "queries": d.queries} for d in done}
        earlier = _read(folder / "timings.json")
        run.write_json("timings.json", {**earlier, **{k: t for k, t in timings.items() if t["queries"]}})
    return Run(folder, suite, vlm, rows, _learned(jobs))


def status_of(folder: Path, catalogue: Catalogue) -> Run:
    """What a run has so far, finished or not. Raises ``RunFolderError`` for a folder without one."""
    config = RunFolder(folder).config()
    try:
        suite, vlm = Suite.model_validate(config["suite"]), str(config["vlm"])
    except (KeyError, ValueError) as error:
        raise RunFolderError(f"{folder}: holds no benchmark run; make one with 'pix2pred bench run'") from error
    jobs = _jobs(folder, suite, catalogue, vlm, folder, StoreMode.REPLAY)
    return Run(folder, suite, vlm, tuple(row for job in jobs for row in job.rows()), _learned(jobs))


def expected(run: Run) -> int:
    """How many tries the run has when it is finished."""
    suite = run.suite
    times = len(suite.seeds) * len(suite.values)
    tries = {f.name: suite.tasks_of(f) for f in suite.families}
    wanted = sum(len(suite.approaches_of(f)) * times * tries[f.name] for f in suite.families)
    return wanted - sum(tries[row.family] for row in run.rows if row.task is None)


def _config(suite: Suite, vlm: str) -> dict[str, Any]:
    return {"suite": suite.document(), "vlm": vlm}


def _jobs(folder: Path, suite: Suite, catalogue: Catalogue, vlm: str, answers: Path, mode: StoreMode) -> list[Job]:
    return [
        Job(folder, suite, family, seed, value, vlm, answers, mode, catalogue)
        for family in suite.families
        for value in suite.values
        for seed in suite.seeds
    ]


def _not_available(jobs: list[Job]) -> dict[str, list[str]]:
    """Why families cannot be run, and which."""
    found: dict[str, dict[str, None]] = {}
    for job in jobs:
        try:
            assert job.family_name, "a family has a name"
        except NotAvailableError as error:
            found.setdefault(str(error), {})[job.family.name] = None
    return {reason: list(families) for reason, families in found.items()}


def _learned(jobs: list[Job]) -> dict[str, dict[str, Any]]:
    found = {}
    for job in jobs:
        for name in job.approaches:
            learned = _read(job.folder / job.place / name / "learned.json")
            if learned:
                found[f"{job.place.removeprefix('cells/')}/{name}"] = learned
    return found


def _read(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
