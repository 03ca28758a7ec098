"""``runs``: the runs in a folder, and two of them compared."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter
from rich.markup import escape
from rich.table import Table

from pix2pred.cli.console import counted, out, plain, print_json, say
from pix2pred.runs.compare import Comparison, RunRow, compare, runs_below

runs = App(name="runs")


@runs.command(name="list")
def list_runs(
    folder: Annotated[Path, Parameter(help="Folder to look in, up to four levels deep.")] = Path("runs"),
    /,
    *,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """List runs: who labelled them, what was selected and learned, what they solved.

    For example:

    - `pix2pred runs list runs`
    """
    found = runs_below(folder)
    if json:
        print_json({"runs": [_document(row) for row in found]})
        return 0
    if not found:
        say(f"{folder}: holds no run; make one with 'pix2pred learn DATA --out RUN'")
        return 0
    table = Table(box=None)
    for column in ("run", "labelled by", "demos", "selected", "operators", "J", "solved", "verdict"):
        table.add_column(column, overflow="fold")
    for row in found:
        table.add_row(*(escape(plain(cell)) for cell in _cells(row)))
    out.print(table)
    return 0


@runs.command(name="compare")
def compare_runs(
    one: Annotated[Path, Parameter(help="Run folder.")],
    other: Annotated[Path, Parameter(help="Another one.")],
    /,
    *,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Compare two runs: settings, labels that differ, predicates and operators that only one of them has.

    For example:

    - `pix2pred runs compare runs/tea runs/tea-robust`
    """
    found = compare(one, other)
    if json:
        print_json(_comparison(found))
    else:
        _print(one, other, found)
    return 0


def _cells(row: RunRow) -> tuple[str, ...]:
    m = row.metrics
    solved = ", ".join(f"{a} of {b}" for a, b in row.solved.values()) or "-"
    if m is None:
        return str(row.folder), row.model, "-", "-", "-", "-", solved, "not finished"
    verdict = "verdict" in m and (counted(len(m["verdict"]), "concern") if m["verdict"] else "nothing stands out")
    js = f"{m['J'][0]:,.0f} to {m['J'][-1]:,.0f}" if m["J"] else "-"
    return (
        str(row.folder), row.model, str(m["demonstrations"]), ", ".join(m["selected"]) or "none", str(m["operators"]),
        js, solved, verdict or "-",
    )  # fmt: skip


def _document(row: RunRow) -> dict[str, object]:
    solved = {name: {"solved": a, "tasks": b} for name, (a, b) in row.solved.items()}
    return {"folder": str(row.folder), "model": row.model, "metrics": row.metrics, "solved": solved}


def _comparison(found: Comparison) -> dict[str, object]:
    return {
        "settings": [{"key": d.key, "one": d.then, "other": d.now} for d in found.settings],
        "labels": [
            {"predicate": c.predicate, "labels": c.labels, "differ": c.differ, "example": c.example}
            for c in found.labels
        ],
        "predicates": {"one": found.predicates[0], "other": found.predicates[1]},
        "operators": {"one": found.operators[0], "other": found.operators[1]},
    }


def _print(one: Path, other: Path, found: Comparison) -> None:
    say(f"A: {one}\nB: {other}")
    if found.equal:
        say("Nothing differs.")
    for difference in found.settings:
        values = "" if difference.key == "data" else f"{difference.then} in A, {difference.now} in B"
        say(f"  {difference.key}: {values or 'demonstrations, pictures or declarations differ'}")
    for count in found.labels:
        say(f"  labels of {count.predicate}: {count.differ:,} of {count.labels:,} differ, such as {count.example}")
    for what, pair in (("selected", found.predicates), ("operator", found.operators)):
        for name, texts in zip("AB", pair, strict=True):
            for text in texts:
                say(f"  {what} in {name} alone: {text}")
