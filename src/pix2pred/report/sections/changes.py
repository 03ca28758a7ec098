"""Before and after: what corrections did to labels, predicates and operators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pix2pred.predicates.correction_rows import LabelRow, MeaningRow, MergeRow, RenameRow, Row, StandingRow
from pix2pred.report.contents import Contents


@dataclass(frozen=True, slots=True)
class Version:
    """What was learned with the first ``corrections`` corrections of a person.

    ``selected`` names the predicates, ``operators`` counts; ``j`` and ``evaluations`` are those of its climb.
    """

    corrections: int
    selected: tuple[str, ...]
    j: float
    operators: int
    evaluations: int


@dataclass(frozen=True, slots=True)
class Changes:
    """What became of a person's corrections, version by version.

    ``gained`` and ``lost`` name operators of the last learning against the one before; ``rows`` are the corrections as
    cells of a table, of which the last ``waiting`` were not learned from yet.
    """

    versions: tuple[Version, ...]
    gained: tuple[str, ...]
    lost: tuple[str, ...]
    rows: tuple[tuple[str, str, str, str], ...]
    waiting: int


def changes(contents: Contents) -> Changes:
    """What became of the corrections; ``waiting`` of them came after the last learning."""
    learned = int(contents.metrics.get("corrections", 0))
    history = [h for h in contents.history if h["corrections"] <= learned]
    versions = tuple(
        Version(
            h["corrections"], tuple(h["selected"]), float(h["steps"][-1]["J"]), len(h["operators"]), h["evaluations"]
        )
        for h in history
    )
    gained: list[str] = []
    lost: list[str] = []
    if len(history) > 1:
        before, after = ({_operator(o) for o in h["operators"]} for h in history[-2:])
        gained, lost = sorted(after - before), sorted(before - after)
    rows = tuple(describe(row) for row in contents.rows)
    return Changes(versions, tuple(gained), tuple(lost), rows, len(contents.rows) - learned)


def describe(row: Row) -> tuple[str, str, str, str]:
    """When, what, old and new."""
    match row:
        case LabelRow():
            return (
                row.when,
                f"{row.atom[0]}({', '.join(row.atom[1:])}), {row.demo}, state {row.state}",
                row.old,
                row.new,
            )
        case RenameRow():
            return row.when, f"name of {row.predicate}", row.old, row.new
        case MergeRow():
            return row.when, f"{row.predicate} means the same as", row.old or "–", row.new or "–"
        case StandingRow():
            return row.when, f"standing of {row.predicate}", row.old, row.new
        case MeaningRow():
            return row.when, f"meaning of {row.predicate}", row.old or "–", row.new or "–"


def _operator(doc: Mapping[str, Any]) -> str:
    """An operator without its number and support, so that equal ones are equal in two versions."""

    def atoms(group: list[list[str]]) -> str:
        return ", ".join(f"{a[0]}({', '.join(a[1:])})" for a in group) or "nothing"

    skill = f"{doc['skill'][0]}({', '.join(doc['skill'][1:])})"
    return f"{skill}: needs {atoms(doc['preconditions'])}; adds {atoms(doc['add'])}; deletes {atoms(doc['delete'])}"
