"""The demonstrations as the robust learner believes them, over the predicates of one world model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pix2pred.learning.operators.robust import Robust
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import AbstractState, Atom, Object, Predicate, TruthTable


@dataclass(frozen=True, slots=True)
class BelievedDemo:
    """A demonstration's objects and the atoms that most probably hold, state by state."""

    objects: tuple[Object, ...]
    states: tuple[AbstractState, ...]


@dataclass(frozen=True, slots=True)
class LabelCounts:
    """Labels of one predicate: how many say true or false, how many of these are believed wrong, how many say neither.

    ``first_true`` of ``first`` atoms are believed to hold in the first state of their demonstration.
    """

    known: int
    wrong: int
    unknown: int
    first: int
    first_true: int


class Believed:
    """Labels of ``table`` repaired by the hidden Markov model of the robust learner."""

    def __init__(self, table: TruthTable, predicates: Sequence[Predicate]) -> None:
        kept = set(predicates)
        restricted = TruthTable(
            tuple(p for p in table.initial if p in kept),
            tuple(c for c in table.pool if c.predicate in kept),
            tuple(demo.restricted(predicates) for demo in table.demos),
        )
        self._table = restricted
        self._repaired = Robust().fit(IndexedTable(restricted)).data
        self.demos = tuple(self._demo(d) for d in range(len(restricted.demos)))

    def _demo(self, d: int) -> BelievedDemo:
        data = self._repaired
        states = []
        for s in range(data.demos[d].states):
            held = (
                Atom(predicate, tuple(data.objects[o] for o in args))
                for p, predicate in enumerate(data.predicates)
                for args in data.extension(d, s, p)
            )
            states.append(frozenset(held))
        return BelievedDemo(self._table.demos[d].objects, tuple(states))

    def counts(self, predicate: Predicate) -> LabelCounts:
        """What became of the labels of ``predicate``."""
        known = wrong = unknown = first = first_true = 0
        for demo, believed in zip(self._table.demos, self.demos, strict=True):
            for column, atom in _columns(demo.atoms, predicate):
                values = [int(v) for v in demo.values[:, column]]
                held = [atom in state for state in believed.states]
                unknown += sum(v < 0 for v in values)
                known += sum(v >= 0 for v in values)
                wrong += sum(v >= 0 and (v == 1) != h for v, h in zip(values, held, strict=True))
                first += 1
                first_true += held[0]
        return LabelCounts(known, wrong, unknown, first, first_true)


def _columns(atoms: Sequence[Atom], predicate: Predicate) -> Iterator[tuple[int, Atom]]:
    return ((i, atom) for i, atom in enumerate(atoms) if atom.predicate == predicate)
