"""One row per (approach, family, value of the axis, seed, task): what happened and why."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from pathlib import Path
from typing import Any


class TryOutcome(StrEnum):
    """How a try ended. The last two are about a whole cell: nothing was tried."""

    SOLVED = "solved"
    FAILED = "failed"
    BUDGET = "budget"
    NEEDS_MODEL = "needs a model"
    NOT_AVAILABLE = "not available"

    @property
    def scored(self) -> bool:
        """Whether the row counts as a try."""
        return self not in (TryOutcome.NEEDS_MODEL, TryOutcome.NOT_AVAILABLE)


class Cause(StrEnum):
    """Where a failure comes from, found by planning and learning again with true labels."""

    WRONG_LABEL = "wrong label"
    WRONG_TRAINING_LABEL = "wrong label in demonstrations"
    WRONG_MODEL = "wrong model"
    """With true labels, in demonstrations and in the task, there is
    no plan that works either."""
    BUDGET = "budget"
    UNDETERMINED = "undetermined"


@dataclass(frozen=True, slots=True)
class Row:
    """A try of a task, or, with ``task`` None, a cell in which nothing was tried.

    ``value`` is the axis's; ``failure`` says how it showed and ``cause`` where it comes from; ``plan_length`` counts
    planned skills, ``nodes`` created search nodes; ``labels`` counts visual atoms asked about at test time whose
    truth is known, ``label_errors`` those of them that were wrong.
    """

    approach: str
    family: str
    value: float | None
    seed: int
    task: str | None
    outcome: TryOutcome
    failure: str = ""
    cause: str = ""
    detail: str = ""
    plan_length: int = 0
    nodes: int | None = None
    labels: int = 0
    label_errors: int = 0

    @classmethod
    def from_document(cls, document: dict[str, Any]) -> Row:
        """The row of a JSON document. Raises ``ValueError`` for another document."""
        try:
            return cls(**{**document, "outcome": TryOutcome(document["outcome"])})
        except (KeyError, TypeError) as error:
            raise ValueError(f"not a benchmark row: {error}") from error

    def document(self) -> dict[str, Any]:
        """The row as JSON-compatible data."""
        return asdict(self)


def dump_rows(rows: Iterable[Row]) -> str:
    """One JSON object per line."""
    return "".join(json.dumps(row.document(), ensure_ascii=False) + "\n" for row in rows)


def dump_csv(rows: Iterable[Row]) -> str:
    """The same as a table."""
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, [f.name for f in fields(Row)], lineterminator="\n")
    writer.writeheader()
    writer.writerows(row.document() for row in rows)
    return buffer.getvalue()


def read_rows(path: Path) -> tuple[Row, ...]:
    """The rows of a ``rows.jsonl``. Raises ``ValueError`` that names the line."""
    rows = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        try:
            rows.append(Row.from_document(json.loads(line)))
        except (ValueError, TypeError) as error:
            raise ValueError(f"{path}:{number}: {error}") from error
    return tuple(rows)
