"""The rows of a corrections file: one correction each, as a person made it.

Every row holds when it was made and the value before and after. Rows name predicates as the model's pool names them,
whatever they are renamed to. The last row about a thing counts.
"""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, TypeAdapter, ValidationError

from pix2pred.structs.formats.documents import Description, Document, PredicateName
from pix2pred.system.errors import Pix2predError, first_fault
from pix2pred.system.files import read_regular

CORRECTIONS = "corrections.jsonl"
"""Where a run keeps them."""

LabelWord = Literal["true", "false", "unknown"]


class Standing(StrEnum):
    """Whether selection may take a predicate, must not, or must."""

    FREE = "free"
    BANNED = "banned"
    PINNED = "pinned"


class CorrectionsError(Pix2predError, ValueError):
    """Corrections that cannot be read or do not fit the run; the message says which row and why."""


class LabelRow(Document):
    """One label set right: ``atom`` is a predicate name and object names."""

    kind: Literal["label"]
    when: str
    demo: str
    state: int = Field(ge=0)
    atom: tuple[str, ...] = Field(min_length=1)
    old: LabelWord
    new: LabelWord


class RenameRow(Document):
    """A predicate called by another name from now on; queries keep the model's word."""

    kind: Literal["rename"]
    when: str
    predicate: str
    old: str
    new: PredicateName


class MergeRow(Document):
    """A predicate declared to mean the same as another one, which stands for both; None: it stands for itself."""

    kind: Literal["merge"]
    when: str
    predicate: str
    old: str | None
    new: str | None


class StandingRow(Document):
    """Whether selection must take a predicate, must not, or may."""

    kind: Literal["standing"]
    when: str
    predicate: str
    old: Standing
    new: Standing


class MeaningRow(Document):
    """What a predicate means, in another sentence from now on: told to the model that looks at new scenes."""

    kind: Literal["meaning"]
    when: str
    predicate: str
    old: str
    new: Description


Row = LabelRow | RenameRow | MergeRow | StandingRow | MeaningRow
_ROW: TypeAdapter[Row] = TypeAdapter(Annotated[Row, Field(discriminator="kind")])

Cell = tuple[str, int, tuple[str, ...]]
"""(demonstration, state, atom)."""


def parse_row(text: str | bytes) -> Row:
    """One line of the file. Raises ``CorrectionsError``."""
    try:
        return _ROW.validate_json(text)
    except ValidationError as error:
        where, first = first_fault(error)
        raise CorrectionsError(f"{where}: {first['msg']}" if where else str(first["msg"])) from error


def read_rows(path: Path) -> tuple[Row, ...]:
    """The rows of a corrections file; none when there is no file.

    A last line that was cut off while being written was never confirmed to anybody and is left out. Raises
    ``CorrectionsError`` naming the line for anything else that is no row.
    """
    if not path.exists():
        return ()
    lines = read_regular(path).split(b"\n")[:-1]
    rows = []
    for number, line in enumerate(lines, start=1):
        try:
            rows.append(parse_row(line))
        except CorrectionsError as error:
            raise CorrectionsError(f"{path}: line {number}: {error}") from error
    return tuple(rows)


def row_line(row: Row) -> bytes:
    """A row as its line in the file."""
    return json.dumps(row.model_dump(mode="json")).encode() + b"\n"
