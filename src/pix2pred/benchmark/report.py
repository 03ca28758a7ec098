"""Writing what a run says: a report beside its rows, and the generated part of a document, between markers."""

from __future__ import annotations

import os
from pathlib import Path

from pix2pred.benchmark.chart import PlotError, draw
from pix2pred.benchmark.claims import load_claims
from pix2pred.benchmark.runner import Run
from pix2pred.benchmark.suite import SuiteError
from pix2pred.benchmark.tables import only_finished, section, summary, summary_csv
from pix2pred.runs.folder import RunFolder
from pix2pred.system.files import write_whole


def begin(name: str, *, short: bool = False) -> str:
    """The line that opens the generated part of a document: all of a report, or what was solved alone."""
    form = "short bench report" if short else "bench report"
    return f"<!-- {form} {name}: written by a program, edit nothing up to the end mark -->"


END = "<!-- end of bench report -->"


def command_of(run: Run) -> str:
    """What made the run."""
    return f"pix2pred bench run {run.suite.name} --vlm {run.vlm}"


def write_report(run: Run, date: str) -> tuple[Path, str | None]:
    """``report/`` in the run folder: report.md, summary.csv and chart.png; gives the report and why a chart lacks."""
    folder = RunFolder(run.folder)
    chart, problem = _chart(run)
    if chart:
        write_whole(run.folder / "report" / "chart.png", chart)
    folder.write("report/summary.csv", summary_csv(run))
    text = section(run, load_claims(), date=date, command=command_of(run), chart="chart.png" if chart else None)
    return folder.write("report/report.md", f"# {run.suite.name}\n\n{text}"), problem


def write_into(document: Path, run: Run, date: str) -> Path | None:
    """Replace what stands between the run's marks in ``document``; gives the chart written beside it.

    A document that does not exist is made. Raises ``SuiteError`` for one without the marks.
    """
    name = run.suite.name
    text = document.read_text(encoding="utf-8") if document.exists() else f"{begin(name)}\n{END}\n"
    short = begin(name, short=True) in text
    opening = begin(name, short=short)
    head, mark, rest = text.partition(opening)
    _, end, tail = rest.partition(END)
    if not mark or not end:
        raise SuiteError(
            f"{document}: has no place for this report; put these lines in it:\n{begin(name)}\n{END}\n"
            f"or, for a summary:\n{begin(name, short=True)}\n{END}"
        )
    chart, _ = _chart(run)
    docs = document.parent / "docs"
    picture = (docs if docs.is_dir() else document.parent) / "images" / f"bench-{name}.png" if chart else None
    if chart and picture:
        write_whole(picture, chart)
    link = os.path.relpath(picture, document.parent) if picture else None
    made = (
        summary(run, date=date, command=command_of(run), chart=link)
        if short
        else section(run, load_claims(), date=date, command=command_of(run), chart=link)
    )
    write_whole(document, f"{head}{mark}\n{made}{END}{tail}".encode())
    return picture


def _chart(run: Run) -> tuple[bytes | None, str | None]:
    try:
        return draw(only_finished(run)), None
    except PlotError as error:
        return None, str(error)
