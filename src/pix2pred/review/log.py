"""The corrections file: rows are appended whole, reach the disk before anybody is told, and are never changed.

Any number of pages and servers may append to one file: a lock orders them, and a row that was made without knowing of
a later one about the same thing is refused instead of silently winning.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

from pix2pred.predicates import CORRECTIONS, Corrections, CorrectionsError
from pix2pred.predicates.correction_rows import (
    LabelRow,
    MeaningRow,
    MergeRow,
    RenameRow,
    Row,
    Standing,
    StandingRow,
    row_line,
)
from pix2pred.predicates.correction_rows import read_rows as read
from pix2pred.structs import Label, TruthTable
from pix2pred.system.errors import Pix2predError
from pix2pred.system.files import refuse_irregular
from pix2pred.system.locks import held

_AS_IT_IS = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
"""No link is followed, no pipe waited for, no line end changed."""


class StaleError(Pix2predError, ValueError):
    """A correction made from a page that did not know of another one; ``present`` is the value now."""

    def __init__(self, present: str | None) -> None:
        super().__init__(f"somebody else changed it meanwhile; it is now {present or 'nothing'}")
        self.present = present


class CorrectionLog:
    """Appends to the corrections of a run whose model said ``said``."""

    def __init__(self, folder: Path, said: TruthTable) -> None:
        self.path = folder / CORRECTIONS
        self._said = said
        self._demos = {demo.name: demo for demo in said.demos}
        self._meanings = {c.predicate.name: c.predicate.description for c in said.pool}
        self._columns = {
            demo.name: {(a.predicate.name, *(o.name for o in a.objects)): i for i, a in enumerate(demo.atoms)}
            for demo in said.demos
        }

    def rows(self) -> tuple[Row, ...]:
        """All rows so far."""
        return read(self.path)

    def append(self, new: Sequence[Row]) -> tuple[Row, ...]:
        """Append rows, all or none, and wait for the disk; gives all rows.

        Raises ``StaleError`` when an ``old`` value is not the present one and ``CorrectionsError`` for rows that make
        no sense in this run.
        """
        with self._locked() as file:
            rows = list(read(self.path))
            for row in new:
                present = self.present(Corrections.of(rows), row)
                if present != row.old:
                    raise StaleError(present)
                rows.append(row)
            Corrections.of(rows).apply(self._said)
            content = b"".join(map(row_line, new))
            self._drop_torn_line(file)
            written = os.write(file, content)
            if written != len(content):
                raise CorrectionsError(f"{self.path}: could not be written completely; is the disk full?")
            os.fsync(file)
        return tuple(rows)

    def present(self, corrections: Corrections, row: Row) -> str | None:
        """The value now of what ``row`` is about, in the words of the file."""
        match row:
            case LabelRow():
                cell = (row.demo, row.state, row.atom)
                return corrections.labels.get(cell) or self._label(row).word
            case RenameRow():
                return corrections.names.get(row.predicate, row.predicate)
            case MergeRow():
                return corrections.merged.get(row.predicate)
            case StandingRow():
                return corrections.standing.get(row.predicate, Standing.FREE)
            case MeaningRow():
                return corrections.meanings.get(row.predicate, self._meanings.get(row.predicate, ""))

    def _label(self, row: LabelRow) -> Label:
        """What the model said; atoms that are false everywhere are not listed."""
        demo = self._demos.get(row.demo)
        if demo is None:
            raise CorrectionsError(f"{row.demo!r} is no demonstration of this run")
        if row.state > len(demo.actions):
            raise CorrectionsError(f"{row.demo} has no state {row.state}")
        column = self._columns[row.demo].get(row.atom)
        return Label.FALSE if column is None else Label(demo.values[row.state, column])

    @contextmanager
    def _locked(self) -> Iterator[int]:
        with held(self.path.with_name(f".{self.path.name}.lock"), wait=True):
            is_new = not self.path.exists()
            refuse_irregular(self.path)
            file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND | _AS_IT_IS, 0o600)
            try:
                if is_new and os.name != "nt":  # where folders cannot be opened
                    folder = os.open(self.path.parent, os.O_RDONLY)
                    os.fsync(folder)
                    os.close(folder)
                yield file
            finally:
                os.close(file)

    @staticmethod
    def _drop_torn_line(file: int) -> None:
        """Cut off a last line that a killed process did not finish; nobody was told that it was saved."""
        size = os.fstat(file).st_size
        os.lseek(file, 0, os.SEEK_SET)
        content = os.read(file, size)
        os.ftruncate(file, content.rfind(b"\n") + 1)


def now() -> str:
    """The time of a correction: UTC, seconds."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
