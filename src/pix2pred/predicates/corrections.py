"""A person's corrections: rows of an append-only file, applied to what the model said, never instead of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from pix2pred.predicates.correction_rows import (
    Cell,
    CorrectionsError,
    LabelRow,
    LabelWord,
    MeaningRow,
    MergeRow,
    RenameRow,
    Row,
    Standing,
    StandingRow,
    read_rows,
)
from pix2pred.structs import Atom, FromVLM, Label, LabelledDemo, Predicate, TruthTable
from pix2pred.structs.formats.names import DeclaredNames, UnknownNameError


@dataclass(frozen=True)
class Corrections:
    """What the rows amount to. ``count`` is their number.

    A corrected label holds for the word's declared contrary too, turned round, unless that has a row of its own.
    """

    count: int = 0
    labels: dict[Cell, LabelWord] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)
    merged: dict[str, str] = field(default_factory=dict)
    standing: dict[str, Standing] = field(default_factory=dict)
    meanings: dict[str, str] = field(default_factory=dict)

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
                case MeaningRow():
                    made.meanings[row.predicate] = row.new
        return made

    def apply(self, table: TruthTable) -> Corrected:
        """The table that learning sees. Raises ``CorrectionsError`` for what does not fit ``table``."""
        predicates = {p.name: p for p in (*table.initial, *(c.predicate for c in table.pool))}
        pool = {c.predicate.name for c in table.pool}
        for name in (*self.names, *self.merged, *self.merged.values(), *self.standing, *self.meanings):
            if name not in pool:
                raise CorrectionsError(_complaint(name, predicates))
        kept = {name: self._representative(name) for name in self.merged}
        for name, other in kept.items():
            if predicates[name].types != predicates[other].types:
                raise CorrectionsError(f"{name} and {other} take different arguments and cannot be merged")
        final = {
            name: replace(p, name=self.names.get(name, name), description=self.meanings.get(name, p.description))
            for name, p in predicates.items()
        }
        gone = {*kept, *(name for name, standing in self.standing.items() if standing is Standing.BANNED)}
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
        pinned = [final[name] for name, s in sorted(self.standing.items()) if s is Standing.PINNED and name in final]
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
        self, demo: LabelledDemo, predicates: dict[str, Predicate], kept: dict[str, str], final: dict[str, Predicate]
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
        atoms = [
            (Atom(final[a.predicate.name], a.objects), i) for i, a in enumerate(demo.atoms) if a.predicate.name in final
        ]
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
        contraries = _contraries(predicates.values())
        said = {(where[parts], state): Label[label.upper()] for (_, state, parts), label in mine.items()}
        turned = {
            (Atom(contraries[atom.predicate], atom.objects), state): label.contrary
            for (atom, state), label in said.items() if atom.predicate in contraries
        }  # fmt: skip
        for (atom, state), label in ({cell: v for cell, v in turned.items() if cell[0] in column} | said).items():
            values[state, column[atom]] = label
            if confidence is not None:
                confidence[state, column[atom]] = np.nan  # it was the model's, about its own label
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


def _contraries(predicates: Iterable[Predicate]) -> dict[Predicate, Predicate]:
    """For words that were declared each other's contrary, of which one was labelled alone, the other one."""
    of_model = {(p.source.phrase, p.types): p for p in predicates if isinstance(p.source, FromVLM)}
    found: dict[Predicate, Predicate] = {}
    for (phrase, types), predicate in of_model.items():
        assert isinstance(predicate.source, FromVLM), "as collected above"
        for word in predicate.source.opposite[:1]:
            other = of_model.get((word, types))
            if other is not None and isinstance(other.source, FromVLM) and phrase in other.source.opposite:
                found |= {predicate: other, other: predicate}
    return found


def load_corrections(path: Path) -> Corrections:
    """The corrections in a file; none when there is no file. Raises ``CorrectionsError``."""
    return Corrections.of(read_rows(path))


def _complaint(name: str, predicates: dict[str, Predicate]) -> str:
    if name in predicates:
        return f"{name} is a given predicate: it cannot be renamed, merged, banned or pinned"
    return str(UnknownNameError("predicate", name, predicates))
