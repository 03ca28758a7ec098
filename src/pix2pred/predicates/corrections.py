"""A person's corrections: rows of an append-only file, applied to what the model said, never instead of it.

Every row holds when it was made and the value before and after. Rows name predicates as the model's pool names them,
whatever they are renamed to. The last row about a thing counts.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from pix2pred.structs import (
    Atom,
    Label,
    LabelledDemo,
    Predicate,
    TruthTable,
)
from pix2pred.structs.formats.documents import Document, PredicateName
from pix2pred.structs.formats.names import DeclaredNames, UnknownNameError
from pix2pred.system.errors import Pix2predError
from pix2pred.system.files import read_regular

CORRECTIONS = "corrections.jsonl"
"""Where a run keeps them."""

LabelWord = Literal["true", "false", "unknown"]
Standing = Literal["free", "banned", "pinned"]


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


Row = LabelRow | RenameRow | MergeRow | StandingRow
_ROW: TypeAdapter[Row] = TypeAdapter(Annotated[Row, Field(discriminator="kind")])

Cell = tuple[str, int, tuple[str, ...]]
"""(demonstration, state, atom)."""


def parse_row(text: str | bytes) -> Row:
    """One line of the file. Raises ``CorrectionsError``."""
    try:
        return _ROW.validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
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


@dataclass(frozen=True)
class Corrections:
    """What the rows amount to. ``count`` is their number."""

    count: int = 0
    labels: dict[Cell, LabelWord] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)
    merged: dict[str, str] = field(default_factory=dict)
    standing: dict[str, Standing] = field(default_factory=dict)

    @classmethod
    def of(cls, rows: Sequence[Row]) -> Corrections:
        """The corrections that ``rows`` make, the last about each thing."""
        made = cls(len(rows))
        for row in rows:
            match row:
                case LabelRow():
                    made.labels[row.demo, row.state, row.atom] = row.new
                case RenameRow():
                    made.names[row.predicate] = row.new
                case MergeRow(new=None):
                    made.merged.pop(row.predicate, None)
                case MergeRow():
                    made.merged[row.predicate] = str(row.new)
                case StandingRow():
                    made.standing[row.predicate] = row.new
        return made

    def apply(self, table: TruthTable) -> Corrected:
        """The table that learning sees. Raises ``CorrectionsError`` for what does not fit ``table``."""
        predicates = {p.name: p for p in (*table.initial, *(c.predicate for c in table.pool))}
        pool = {c.predicate.name for c in table.pool}
        for name in (*self.names, *self.merged, *self.merged.values(), *self.standing):
            if name not in pool:
                raise CorrectionsError(_complaint(name, predicates))
        kept = {name: self._representative(name) for name in self.merged}
        for name, other in kept.items():
            if predicates[name].types != predicates[other].types:
                raise CorrectionsError(f"{name} and {other} take different arguments and cannot be merged")
        final = {name: replace(p, name=self.names.get(name, name)) for name, p in predicates.items()}
        gone = {*kept, *(name for name, standing in self.standing.items() if standing == "banned")}
        final = {name: p for name, p in final.items() if name not in gone}
        names = [p.name for p in final.values()]
        if repeated := sorted({n for n in names if names.count(n) > 1}):
            raise CorrectionsError(f"two predicates are called {repeated[0]}; rename one or merge them")
        demos = tuple(self._demo(demo, predicates, kept, final) for demo in table.demos)
        known = {demo.name for demo in table.demos}
        if lost := next((cell for cell in self.labels if cell[0] not in known), None):
            raise CorrectionsError(f"a correction is about {lost[0]!r}, which is no demonstration of this run")
        corrected = TruthTable(
            table.initial,
            tuple(replace(c, predicate=final[c.predicate.name]) for c in table.pool if c.predicate.name in final),
            demos,
        )
        pinned = [final[name] for name, s in sorted(self.standing.items()) if s == "pinned" and name in final]
        return Corrected(corrected, tuple(p for p in pinned if p in corrected.ever_true))

    def _representative(self, name: str) -> str:
        """The predicate that stands for ``name`` after all merges."""
        seen = [name]
        while (other := self.merged.get(seen[-1])) is not None:
            if other in seen:
                raise CorrectionsError(f"{name} is merged with itself: {' > '.join((*seen, other))}")
            seen.append(other)
        return seen[-1]

    def _demo(
        self,
        demo: LabelledDemo,
        predicates: dict[str, Predicate],
        kept: dict[str, str],
        final: dict[str, Predicate],
    ) -> LabelledDemo:
        demo = self._relabelled(demo, predicates)
        column = {(a.predicate.name, a.objects): i for i, a in enumerate(demo.atoms)}
        values = demo.values.copy()
        confidence = None if demo.confidence is None else demo.confidence.copy()
        for (name, objects), i in column.items():
            target = column.get((kept[name], objects)) if name in kept else None
            if target is not None:
                unsure = values[:, target] == Label.UNKNOWN
                values[unsure, target] = values[unsure, i]
                if confidence is not None:
                    confidence[unsure, target] = confidence[unsure, i]
        atoms = [(Atom(final[a.predicate.name], a.objects), i) for i, a in enumerate(demo.atoms) if _in(a, final)]
        atoms.sort(key=lambda pair: pair[0])
        columns = [i for _, i in atoms]
        return replace(
            demo,
            atoms=tuple(a for a, _ in atoms),
            values=values[:, columns],
            confidence=None if confidence is None else confidence[:, columns],
        )

    def _relabelled(self, demo: LabelledDemo, predicates: dict[str, Predicate]) -> LabelledDemo:
        """``demo`` with corrected labels, of atoms that were false everywhere, too, and with the atoms merges need."""
        mine = {cell: label for cell, label in self.labels.items() if cell[0] == demo.name}
        names = DeclaredNames((), (), tuple(predicates.values()))
        objects = {o.name: o for o in demo.objects}
        where = {}
        for _, state, parts in mine:
            try:
                where[parts] = names.atom(parts[0], parts[1:], objects)
            except ValueError as error:
                raise CorrectionsError(f"a correction of {demo.name}: {error}") from error
            if state > len(demo.actions):
                raise CorrectionsError(f"a correction of {demo.name}: it has no state {state}")
        for atom in demo.atoms:
            if (other := self.merged.get(atom.predicate.name)) is not None:
                stand_in = Atom(predicates[self._representative(other)], atom.objects)
                where.setdefault((stand_in.predicate.name, *(o.name for o in atom.objects)), stand_in)
        demo = with_atoms(demo, where.values())
        column = {atom: i for i, atom in enumerate(demo.atoms)}
        values = demo.values.copy()
        confidence = None if demo.confidence is None else demo.confidence.copy()
        for (_, state, parts), label in mine.items():
            values[state, column[where[parts]]] = Label[label.upper()]
            if confidence is not None:
                confidence[state, column[where[parts]]] = np.nan  # it was the model's, about its own label
        return replace(demo, values=values, confidence=confidence)


@dataclass(frozen=True, slots=True)
class Corrected:
    """The table after corrections, and the predicates that selection has to take."""

    table: TruthTable
    pinned: tuple[Predicate, ...]


def with_atoms(demo: LabelledDemo, atoms: Iterable[Atom]) -> LabelledDemo:
    """``demo`` with columns for all of ``atoms``; new ones are false everywhere."""
    new = set(atoms) - set(demo.atoms)
    if not new:
        return demo
    ordered = tuple(sorted((*demo.atoms, *new)))
    column = {atom: i for i, atom in enumerate(ordered)}
    values = np.full((len(demo.actions) + 1, len(ordered)), Label.FALSE, dtype=np.int8)
    old = [column[a] for a in demo.atoms]
    values[:, old] = demo.values
    confidence = None
    if demo.confidence is not None:
        confidence = np.full(values.shape, np.nan, dtype=np.float32)
        confidence[:, old] = demo.confidence
    return replace(demo, atoms=ordered, values=values, confidence=confidence)


def load_corrections(path: Path) -> Corrections:
    """The corrections in a file; none when there is no file. Raises ``CorrectionsError``."""
    return Corrections.of(read_rows(path))


def row_line(row: Row) -> bytes:
    """A row as its line in the file."""
    return json.dumps(row.model_dump(mode="json")).encode() + b"\n"


def _in(atom: Atom, final: dict[str, Predicate]) -> bool:
    return atom.predicate.name in final


def _complaint(name: str, predicates: dict[str, Predicate]) -> str:
    if name in predicates:
        return f"{name} is a given predicate: it cannot be renamed, merged, banned or pinned"
    return str(UnknownNameError("predicate", name, predicates))
