"""Which actions happen in data that shows only pictures, and when: the file a person writes beside it.

Three forms of one thing: ``.yaml`` says everything, ``.csv`` is a table of times, ``.txt`` a list of actions.
"""

from __future__ import annotations

import csv
import io
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, StringConstraints

from pix2pred.demos.files.documents import FileDoc, Number, Objects, Sheet, load_document
from pix2pred.demos.files.folders import FOLDER_NAME, text_of
from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.yaml_lines import LinedData, Loc
from pix2pred.structs.formats.documents import Document

_CLOCK = re.compile(r"(?:\d{1,3}:){0,2}\d{1,9}(?:\.\d{1,9})?\Z", re.ASCII)
"""``12.5``, ``1:12.5`` or ``0:01:12.5``."""

_COLUMNS = ("seconds", "action")
_MAX_ROWS = 100_000

Moment = Annotated[Number, Field(ge=0)]
"""Seconds from the beginning; in a folder of frames, the position of a frame, counted from 0."""


class StepDoc(Document):
    """An action, and when it has been done."""

    do: str = Field(description="the action, such as Pick(robot, cup); TODO when it is to be filled in later")
    until: Moment | None = Field(default=None, description="when it is done: seconds, or the position of a frame")


class SegmentDoc(Document):
    """One demonstration: where it begins, and what is done."""

    name: Annotated[str, StringConstraints(pattern=f"^{FOLDER_NAME.pattern[:-2]}$")] = Field(
        description="name of the demonstration, which names its folder"
    )
    source: str | int | None = Field(
        default=None, alias="from", description="sub-folder of frames, video file, or number of the LeRobot episode"
    )
    objects: Objects = Field(default=(), description="default: all that domain.yaml declares")
    goal: tuple[str, ...] = ()
    start: Moment | None = Field(default=None, description="when the first action begins [default: 0]")
    steps: Annotated[tuple[StepDoc, ...], Field(min_length=1)]


class ImportDoc(FileDoc):
    """What a person knows of the data: the demonstrations in it and their actions."""

    FORMAT = "pix2pred-import"

    format: Literal["pix2pred-import"]
    version: Literal[1]
    demos: Annotated[tuple[SegmentDoc, ...], Field(min_length=1)]


@dataclass(frozen=True, slots=True)
class Segment:
    """A demonstration of the side-car, with the lines its problems are reported at."""

    doc: SegmentDoc
    sheet: Sheet
    loc: Loc

    def problem(self, loc: Loc, message: str) -> Problem:
        """A problem with the entry at ``loc`` of this demonstration."""
        return Problem(self.sheet.file, self.sheet.yaml.line((*self.loc, *loc)), message)

    def moments(self) -> tuple[float, ...]:
        """The time of every state: the start, then the end of each step. Raises ``FolderError``."""
        found: list[Problem] = []
        times = [self.doc.start or 0.0]
        for i, step in enumerate(self.doc.steps):
            if step.until is None:
                found.append(self.problem(("steps", i), "'until' is missing: when is the action done?"))
            elif step.until <= times[-1]:
                found.append(self.problem(("steps", i), f"is done at {step.until:g}, before it begins ({times[-1]:g})"))
            else:
                times.append(step.until)
        if found:
            raise FolderError(found)
        return tuple(times)

    def has_moments(self) -> bool:
        """Whether any time is given."""
        return self.doc.start is not None or any(step.until is not None for step in self.doc.steps)


def read_sidecar(file: Path) -> tuple[Segment, ...]:
    """The demonstrations named in ``file`` (.yaml, .csv or .txt). Raises ``FolderError`` with all that is wrong."""
    found: list[Problem] = []
    if file.suffix.lower() in (".yaml", ".yml"):
        loaded = load_document(file, file.resolve().parent, ImportDoc, found)
    else:
        loaded = _read_table(file, found)
    if loaded is None or found:
        raise FolderError(found)
    sheet, doc = loaded
    names: set[str] = set()
    for i, demo in enumerate(doc.demos):
        if demo.name.casefold() in names:
            sheet.report(("demos", i, "name"), f"demonstration {demo.name!r} is there twice")
        names.add(demo.name.casefold())
    if found:
        raise FolderError(found)
    return tuple(Segment(demo, sheet, ("demos", i)) for i, demo in enumerate(doc.demos))


def _read_table(file: Path, found: list[Problem]) -> tuple[Sheet, ImportDoc] | None:
    """A CSV table or a list of actions as the document it stands for."""
    text = text_of(file)
    match file.suffix.lower():
        case ".csv":
            demos, lines = _from_csv(file, text, found)
        case ".txt":
            demos, lines = _from_list(file, text)
        case _:
            raise FolderError.about(file, "is not read; write a .yaml, .csv or .txt file")
    if not demos and not found:
        found.append(Problem(file, None, "names no action"))
    if found:
        return None
    document = ImportDoc.model_validate({"format": ImportDoc.FORMAT, "version": 1, "demos": demos})
    return Sheet(file, LinedData(None, lines), found), document


def _from_list(file: Path, text: str) -> tuple[list[dict[str, Any]], dict[Loc, int]]:
    """One action a line; empty lines and those that begin with ``#`` are passed over."""
    rows = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1)]
    rows = [(i, line) for i, line in rows if line and not line.startswith("#")]
    lines: dict[Loc, int] = {(): 1, **{("demos", 0, "steps", k): i for k, (i, _) in enumerate(rows)}}
    demos = [{"name": demo_name(file.stem), "steps": [{"do": line} for _, line in rows]}] if rows else []
    return demos, _with_parents(lines)


def _from_csv(file: Path, text: str, found: list[Problem]) -> tuple[list[dict[str, Any]], dict[Loc, int]]:
    """Columns ``seconds`` and ``action``, if wanted ``demo`` and ``from``; a row without action is the beginning."""
    reader = csv.DictReader(io.StringIO(text), skipinitialspace=True)
    demos: dict[str, dict[str, Any]] = {}
    lines: dict[Loc, int] = {(): 1}
    try:
        if missing := [c for c in _COLUMNS if c not in (reader.fieldnames or ())]:
            found.append(Problem(file, 1, f"needs the columns {', '.join(_COLUMNS)}; {', '.join(missing)} is missing"))
            return [], {}
        for row in reader:
            if reader.line_num > _MAX_ROWS:
                found.append(Problem(file, reader.line_num, f"more than {_MAX_ROWS} rows are not read"))
                break
            _take_row(row, reader.line_num, demos, lines, file, found)
    except csv.Error as error:
        found.append(Problem(file, reader.line_num, f"is not a table ({error})"))
    for name, demo in demos.items():
        if not demo["steps"]:
            found.append(Problem(file, None, f"demonstration {name!r} has no action"))
    return list(demos.values()), _with_parents(lines)


def _take_row(
    row: Mapping[str, Any], line: int, demos: dict[str, dict[str, Any]], lines: dict[Loc, int], file: Path,
    found: list[Problem],
) -> None:  # fmt: skip
    if None in row:
        found.append(Problem(file, line, "has more cells than there are columns; put actions into double quotes"))
        return
    cell = {key: (value or "").strip() for key, value in row.items()}
    if not any(cell.values()):
        return
    name = demo_name(cell.get("demo") or file.stem)
    demo = demos.setdefault(name, {"name": name, "steps": []})
    loc = ("demos", list(demos).index(name))
    if cell.get("from"):
        demo["from"] = int(cell["from"]) if cell["from"].isdecimal() and len(cell["from"]) < 10 else cell["from"]
    seconds = clock(cell["seconds"])
    if seconds is None:
        found.append(Problem(file, line, f"{cell['seconds']!r} is no time; write seconds, or minutes:seconds"))
    elif cell["action"]:
        lines[(*loc, "steps", len(demo["steps"]))] = line
        demo["steps"].append({"do": cell["action"], "until": seconds})
    elif demo["steps"]:
        found.append(Problem(file, line, "has no action; only the first row, the beginning, may have none"))
    else:
        demo["start"] = seconds
        lines[(*loc, "start")] = line


def clock(text: str) -> float | None:
    """``72.5``, ``1:12.5`` or ``0:01:12.5`` in seconds; None for anything else."""
    if not _CLOCK.match(text):
        return None
    seconds = 0.0
    for part in text.split(":"):
        seconds = 60 * seconds + float(part)
    return seconds


def _with_parents(lines: Mapping[Loc, int]) -> dict[Loc, int]:
    """Also a line for every entry that holds one with a line: that of the first."""
    full: dict[Loc, int] = {}
    for loc, line in lines.items():
        for end in range(len(loc) + 1):
            full.setdefault(loc[:end], line)
    return full


def demo_name(text: str, taken: Sequence[str] = ()) -> str:
    """``text`` as the name of a demonstration: what is left of it in plain letters, different from those ``taken``."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    base = re.sub(r"[^A-Za-z0-9_.\-]+", "-", plain).strip("-._")[:80] or "demo"
    used = {name.casefold() for name in taken}
    names = (base if n == 1 else f"{base}-{n}" for n in range(1, len(used) + 2))
    return next(name for name in names if name.casefold() not in used)
