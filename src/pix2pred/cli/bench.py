"""``bench``: the published comparison and other suites, as one command."""

from __future__ import annotations

from collections import Counter
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter
from rich.markup import escape
from rich.table import Table

from pix2pred.benchmark import Run, SuiteError, TryOutcome, load_suite, run_suite, status_of
from pix2pred.benchmark.chart import PlotError, check_charts
from pix2pred.benchmark.claims import judge, load_claims
from pix2pred.benchmark.report import write_into, write_report
from pix2pred.benchmark.runner import expected
from pix2pred.benchmark.tables import comparison, models_of
from pix2pred.cli.console import bars, err, out, print_json
from pix2pred.cli.ranges import WORKERS, output_folder, quoted
from pix2pred.registry import Registry
from pix2pred.system.parallel import Backend, Workers
from pix2pred.vlm import StoreMode

bench = App(name="bench")


@bench.command
def run(
    suite: Annotated[str, Parameter(help="A bundled suite (paper, smoke, ...) or a YAML file.")],
    /,
    *,
    out: Annotated[
        Path | None, Parameter(help="Run folder [default: runs/bench-SUITE].", validator=output_folder)
    ] = None,
    vlm: Annotated[str, Parameter(help="Model that proposes, labels, plans and writes code.")] = "offline",
    jobs: Annotated[int, Parameter(help="Workers; the rows do not depend on it.", validator=WORKERS)] = 1,
    backend: Annotated[Backend, Parameter(help="What runs the workers.")] = Backend.LOKY,
    answers: Annotated[Path | None, Parameter(help="Answer store to share between runs [default: OUT].")] = None,
    mode: Annotated[StoreMode, Parameter(help="live: ask; resume: ask what is not stored; replay: never ask.")] = (
        StoreMode.RESUME
    ),
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Run a suite; the same command goes on where an interrupted run stopped.

    For example:

    - `pix2pred bench run paper --vlm offline --jobs 2`
    """
    chosen = load_suite(suite)
    folder = out or Path("runs") / f"bench-{chosen.name}"
    try:
        check_charts()
    except PlotError as error:
        err.print(f"warning: 'pix2pred bench report' will draw no chart: {error}", markup=False, soft_wrap=True)
    with bars() as progress:
        done = run_suite(
            folder,
            chosen,
            registry,
            vlm=vlm,
            workers=Workers(jobs, backend),
            answers=answers,
            mode=mode,
            progress=progress,
            warn=lambda sentence: err.print(f"warning: {sentence}", markup=False, soft_wrap=True),
        )
    if json:
        print_json({"run": str(folder), "rows": len(done.rows), "outcomes": _outcomes(done)})
    else:
        _print(done)
        err.print(f"run folder: {folder}; tables and claims: pix2pred bench report {quoted(folder)}", markup=False)
    return 0


@bench.command
def status(
    folder: Annotated[Path, Parameter(help="Run folder of a benchmark.")],
    /,
    *,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """How far a run is, finished or not.

    For example:

    - `pix2pred bench status runs/bench-paper`
    """
    run = status_of(folder, registry)
    tried, total = sum(row.task is not None for row in run.rows), expected(run)
    if json:
        print_json({"tried": tried, "of": total, "outcomes": _outcomes(run)})
    else:
        _print(run)
        out.print(f"{tried} of {total} tries")
    return 0 if tried >= total else 1


@bench.command
def report(
    *folders: Annotated[Path, Parameter(help="Run folders of benchmarks.")],
    write: Annotated[Path | None, Parameter(help="Document whose marked part to write, e.g. docs/results.md.")] = None,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Tables, chart and published claims of one or more runs, in RUN/report and on the screen.

    For example:

    - `pix2pred bench report runs/bench-paper --write docs/results.md`
    """
    if not folders:
        raise SuiteError("name at least one run folder: pix2pred bench report runs/bench-paper")
    today = datetime.now(tz=UTC).date().isoformat()
    verdicts: dict[str, dict[str, str]] = {}
    for folder in folders:
        run = status_of(folder, registry)
        path, problem = write_report(run, today)
        verdicts[str(folder)] = {c.id: judge(c, run).verdict.value for c in load_claims().claims}
        if write:
            write_into(write, run, today)
        if not json:
            out.print(path.read_text(encoding="utf-8"), markup=False, soft_wrap=True)
        if problem:
            err.print(problem, markup=False)
    if json:
        print_json({"claims": verdicts})
    return 0


@bench.command
def compare(
    left: Annotated[Path, Parameter(help="Run folder of a benchmark.")],
    right: Annotated[Path, Parameter(help="Another one.")],
    /,
    *,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Two runs side by side, over the tasks that both tried.

    For example:

    - `pix2pred bench compare runs/bench-paper runs/bench-paper-hosted`
    """
    runs = [status_of(folder, registry) for folder in (left, right)]
    for name, folder, run in zip("AB", (left, right), runs, strict=True):
        out.print(f"{name}: {folder}, {run.suite.name}, {', '.join(models_of(run))}", markup=False, soft_wrap=True)
    out.print("\n" + comparison(*runs), markup=False, soft_wrap=True)
    return 0


def _outcomes(run: Run) -> dict[str, int]:
    counts = Counter(row.outcome for row in run.rows)
    return {outcome.value: counts[outcome] for outcome in TryOutcome if counts[outcome]}


def _print(run: Run) -> None:
    families = [entry.name for entry in run.suite.families]
    table = Table(title=f"Solved, {run.suite.name}", title_justify="left", box=None)
    for column in ("approach", *families):
        table.add_column(column)
    for approach in run.suite.approaches:
        table.add_row(approach, *(escape(_cell(run, approach, family)) for family in families))
    out.print(table)


def _cell(run: Run, approach: str, family: str) -> str:
    rows = [r for r in run.rows if (r.approach, r.family) == (approach, family)]
    tried = [r for r in rows if r.outcome.scored]
    if tried:
        return f"{sum(r.outcome == TryOutcome.SOLVED for r in tried)} of {len(tried)}"
    return rows[0].outcome.value if rows else "not run"
