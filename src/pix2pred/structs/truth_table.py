"""Which atoms hold in which demonstration states: the only thing learning sees (method 3.7)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pix2pred.structs.goals.opposites import affirmed, is_denial
from pix2pred.structs.objects import Object
from pix2pred.structs.predicates import Atom, FromVLM, Predicate
from pix2pred.structs.skills import Action
from pix2pred.structs.states import AbstractState


class Label(IntEnum):
    """The value of an atom in a state, as a model, a person or a program gave it; arrays hold it as one byte."""

    FALSE = 0
    TRUE = 1
    UNKNOWN = -1

    @property
    def word(self) -> Literal["true", "false", "unknown"]:
        """What files and people call it."""
        return _WORDS[self]

    @property
    def contrary(self) -> Label:
        """What it says of the contrary of its atom; nothing, where it says nothing."""
        return {Label.TRUE: Label.FALSE, Label.FALSE: Label.TRUE}.get(self, self)

    @classmethod
    def of(cls, held: bool) -> Label:
        """True or false, from a value that is known."""
        return cls.TRUE if held else cls.FALSE


_WORDS: dict[Label, Literal["true", "false", "unknown"]] = {
    Label.TRUE: "true", Label.FALSE: "false", Label.UNKNOWN: "unknown",
}  # fmt: skip

Values = NDArray[np.int8]
"""Labels of shape (states, atoms): 1 true, 0 false, -1 unknown."""

Confidence = NDArray[np.float32]
"""Probabilities of labels, of shape (states, atoms), in [0, 1]; NaN where nothing is known of it."""


def unknown_as_false(values: Values) -> NDArray[np.bool_]:
    """The closed-world reading of labels: unknown counts as false, as the method asks (method 3.6)."""
    held: NDArray[np.bool_] = values == Label.TRUE
    return held


@dataclass(frozen=True, eq=False)
class LabelledDemo:
    """A demonstration with symbols in place of pictures.

    ``values`` has a row for every state and a column for each of ``atoms``, one byte each; ``confidence``, where known,
    has the same shape and holds probabilities of the values. ``alternatives`` are goals that are as good as ``goal``.
    """

    name: str
    objects: tuple[Object, ...]
    actions: tuple[Action, ...]
    goal: tuple[Atom, ...]
    atoms: tuple[Atom, ...]
    values: Values
    confidence: Confidence | None = None
    alternatives: tuple[tuple[Atom, ...], ...] = ()

    def __post_init__(self) -> None:
        expected = (len(self.actions) + 1, len(self.atoms))
        for array in (self.values, self.values if self.confidence is None else self.confidence):
            if array.shape != expected:
                raise ValueError(f"demonstration {self.name}: labels have shape {array.shape}, not {expected}")

    def abstract_states(self) -> tuple[AbstractState, ...]:
        """The set of atoms that hold, state by state."""
        held = unknown_as_false(self.values)
        return tuple(frozenset(self.atoms[i] for i in np.flatnonzero(row)) for row in held)

    def restricted(self, predicates: Iterable[Predicate]) -> LabelledDemo:
        """The same demonstration with the atoms of ``predicates`` only."""
        kept = set(predicates)
        columns = [i for i, atom in enumerate(self.atoms) if atom.predicate in kept]
        return replace(
            self,
            atoms=tuple(self.atoms[i] for i in columns),
            values=self.values[:, columns],
            confidence=None if self.confidence is None else self.confidence[:, columns],
        )

    @property
    def goals(self) -> tuple[tuple[Atom, ...], ...]:
        """All conjunctions of which one holds in the last state."""
        return (self.goal, *self.alternatives)

    @property
    def reached(self) -> tuple[Atom, ...]:
        """The goal that was demonstrated: of several the first of those that the last state contradicts least.

        What is given counts more than any number of labels of a model, and a false one more than unknown ones.
        """
        if not self.alternatives:
            return self.goal  # whatever is said of it
        last = dict(zip(self.atoms, map(Label, self.values[-1].tolist()), strict=True))
        return min(self.goals, key=lambda goal: _contradictions(goal, last))

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, LabelledDemo)
            and (self.name, self.objects, self.actions, self.goal, self.alternatives, self.atoms)
            == (other.name, other.objects, other.actions, other.goal, other.alternatives, other.atoms)
            and np.array_equal(self.values, other.values)
            and _same(self.confidence, other.confidence)
        )


def _contradictions(goal: Iterable[Atom], last: Mapping[Atom, Label]) -> tuple[int, int, int]:
    """How many atoms of ``goal`` do not hold by what is given, and by labels, and of how many nobody knows."""
    certain = labelled = unknown = 0
    for atom in goal:
        wanted = Label.FALSE if is_denial(atom) else Label.TRUE
        said = affirmed(atom)
        value = last.get(said, Label.FALSE)
        if value is Label.UNKNOWN:
            unknown += 1
        elif value is not wanted:
            seen = isinstance(said.predicate.source, FromVLM)
            labelled, certain = labelled + seen, certain + (not seen)
    return certain, labelled, unknown


def _same(one: Confidence | None, other: Confidence | None) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other, equal_nan=True)


@dataclass(frozen=True, slots=True)
class Candidate:
    """A predicate of the pool and what choosing it costs in the objective (method 4.5)."""

    predicate: Predicate
    cost: float

    def __lt__(self, other: Candidate) -> bool:
        return self.predicate < other.predicate


@dataclass(frozen=True)
class TruthTable:
    """Labelled demonstrations over the initial predicates and a pool of candidates."""

    initial: tuple[Predicate, ...]
    pool: tuple[Candidate, ...]
    demos: tuple[LabelledDemo, ...]

    @cached_property
    def ever_true(self) -> frozenset[Predicate]:
        """Predicates with at least one true label; only these become candidates (method 3.7)."""
        return frozenset(
            demo.atoms[i].predicate
            for demo in self.demos
            for i in np.flatnonzero((demo.values == Label.TRUE).any(axis=0))
        )

    def candidates(self) -> tuple[Candidate, ...]:
        """The members of the pool that are true at least once, sorted by name."""
        return tuple(sorted(c for c in self.pool if c.predicate in self.ever_true))

    def count(self, value: Label) -> int:
        """How many labels have ``value``."""
        return sum(int((demo.values == value).sum()) for demo in self.demos)
