"""What a person sees: progress on stderr, results on stdout."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table

from pix2pred.runs.verdict import meaning, sentences
from pix2pred.structs import Operator
from pix2pred.system.errors import Pix2predError
from pix2pred.system.progress import Stage

out = Console(highlight=False, emoji=False)
err = Console(stderr=True, highlight=False, emoji=False)

_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters, C1 included, those that reorder text, and halves of characters, which no file can hold."""
_ENDLESS = re.compile(r"(\S{200})\S{200,}(\S{20})")
"""Words longer than any path or name that a person wants to read."""

_STAGES = {
    Stage.GENERATE: "Drawing demonstrations",
    Stage.PHOTOS: "Copying photos",
    Stage.IMPORT: "Taking pictures",
    Stage.PROPOSE: "Proposing predicates",
    Stage.LABEL: "Labelling states",
    Stage.SELECT: "Selecting predicates",
    Stage.DOUBT: "Looking for wrong labels",
    Stage.SOLVE: "Solving tasks",
    Stage.BENCH: "Running the suite",
    Stage.DISTIL: "Teaching words",
}


class UsageError(Pix2predError, ValueError):
    """Arguments that do not go together; the message says which do."""


def plain(text: str) -> str:
    """``text`` without what a terminal would obey: control characters are shown as pictures of themselves.

    Line ends and tabs stay, and of endless words the beginning and the end. Whatever a model or a file says passes
    through here before it is printed.
    """
    return _ENDLESS.sub(r"\1…\2", _CONTROL.sub(_pictured, text))


def _pictured(match: re.Match[str]) -> str:
    code = ord(match[0])
    return chr(0x2400 + code) if code < 0x20 else "\u2421" if code == 0x7F else f"\\u{code:04x}"


class ProgressBars:
    """Implements ``Progress``: bars, one per stage, in the order in which stages begin."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._tasks: dict[Stage, TaskID] = {}

    def __call__(self, stage: Stage, done: int, total: int, text: str) -> None:
        if stage not in self._tasks:
            self._tasks[stage] = self._progress.add_task(_STAGES[stage], total=total, note="")
        self._progress.update(self._tasks[stage], completed=done, total=total, note=escape(plain(text)))


@contextmanager
def bars() -> Iterator[ProgressBars]:
    """Show progress bars on stderr while the block runs."""
    columns = (
        TextColumn("{task.description:<24}"),
        BarColumn(bar_width=30),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("[dim]{task.fields[note]}"),
    )
    with Progress(*columns, console=err) as progress:
        yield ProgressBars(progress)


def print_json(data: Mapping[str, Any]) -> None:
    """One machine-readable object on one line, the last of stdout."""
    print(json.dumps(data, ensure_ascii=False))


def print_learned(metrics: Mapping[str, Any], operators: Sequence[Operator]) -> None:
    """What was proposed, selected and learned, and the verdict on it, in sentences to read aloud."""
    words = {
        a.predicate.name: meaning(a.predicate) for op in operators for a in (*op.preconditions, *op.add, *op.delete)
    }
    selected = ", ".join(words.get(name) or name for name in metrics["selected"])
    js = metrics["J"]
    say(
        f"Learned from {counted(metrics['demonstrations'], 'demonstration')} with "
        f"{counted(metrics['transitions'], 'skill')}, labelled by {metrics['labels_from']}."
    )
    say(
        f"Of {counted(metrics['candidates'], 'candidate predicate')} (from {metrics['proposed']} usable and "
        f"{metrics['rejected']} rejected atoms) "
        + (
            f"{counted(len(metrics['selected']), '', 'was', 'were')} selected: {selected}."
            if selected
            else "none was selected."
        )
    )
    if js:
        say(f"J, the work of planning the demonstrations again, went from {js[0]:,.0f} to {js[-1]:,.0f} search nodes.")
    if metrics["corrections"]:
        say(f"With {counted(metrics['corrections'], 'correction')} of yours.")
    say(f"{counted(len(operators), 'operator')}:")
    for op, sentence in zip(operators, sentences(operators), strict=True):
        out.print(plain(f"  {op.name:<4} {sentence}"), markup=False, soft_wrap=True)
    for warning in metrics["warnings"]:
        out.print(f"[yellow]warning:[/yellow] {escape(plain(warning))}", soft_wrap=True)
    print_verdict(metrics["verdict"])


def print_verdict(verdict: Sequence[str]) -> None:
    """What is wrong with a world model, a line each, or that nothing stands out."""
    if not verdict:
        say("Verdict: nothing stands out against this world model.")
        return
    say("Verdict: do not rely on this world model yet.")
    for concern in verdict:
        out.print(f"  [yellow]-[/yellow] {escape(plain(concern))}", soft_wrap=True)


def say(text: str) -> None:
    """A line of text on stdout, which the terminal wraps."""
    out.print(plain(text), markup=False, soft_wrap=True)


def counted(number: int, thing: str, one: str = "", many: str = "") -> str:
    """``1 skill``, ``3 skills``; ``one`` or ``many`` follows as fits."""
    name = thing + ("" if number == 1 or not thing else "s")
    return " ".join(part for part in (f"{number:,}", name, one if number == 1 else many) if part)


def print_solved(summary: Mapping[str, Any]) -> None:
    """One line per task, then the count."""
    table = Table(title="Tasks", title_justify="left", box=None)
    for column in ("task", "result", "skills", "why"):
        table.add_column(column)
    for episode in summary["episodes"]:
        result = "[green]solved" if episode["solved"] else f"[red]{episode['failure']}"
        table.add_row(escape(episode["task"]), result, str(len(episode["steps"])), escape(plain(episode["detail"])))
    out.print(table)
    out.print(f"solved {summary['solved']} of {summary['tasks']}")


def print_estimated(estimate: Mapping[str, Any]) -> None:
    """What a run would ask, stage by stage, and in all."""
    table = Table(title=f"What would be asked of {escape(estimate['model'])}", title_justify="left", box=None)
    fields = ("queries", "from_store", "pictures", "atoms", "input_tokens", "cached_tokens", "output_tokens")
    for column in ("stage", *fields, "dollars"):
        table.add_column(column.replace("_", " "), justify="left" if column == "stage" else "right")
    for stage, row in [*estimate["stages"].items(), ("in all", estimate)]:
        cost = "unknown" if row["dollars"] is None else f"{row['dollars']:.4f}"
        table.add_row(stage, *(f"{row[f]:,}" for f in fields), cost)
    out.print(table)
    if estimate["assumed_predicates"]:
        out.print("The proposals are not known yet: atoms, tokens and cost of labelling rest on an assumed proposal.")
    if estimate["cached_tokens"]:
        out.print(
            "Cached tokens cost less where questions follow closely on one another; the dollars are without that."
        )
    out.print("Tokens are estimated from the length of the texts; nothing was sent.")
