"""Which labels are probably wrong: where the given labels disagree with the most probable values along demonstrations.

The beliefs are those of ``repair``, a hidden Markov model per ground atom fitted to all demonstrations. A wrong label
matters when its predicate does: for the operators at hand, or for those that would be learned if labels were right.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pix2pred.learning.clustering import partition
from pix2pred.learning.data import Data
from pix2pred.learning.repair import repair
from pix2pred.structs import FALSE, TRUE, Atom, FromVLM, LabelledDemo, Predicate, TruthTable

UNLIKELY = 0.5
"""Labels that are wrong with a higher probability are doubted."""


@dataclass(frozen=True, slots=True)
class Doubt:
    """A label that is wrong with probability ``wrong`` if ``likely`` is the true value."""

    state: int
    label: int
    likely: int
    wrong: float


@dataclass(frozen=True, slots=True)
class Timeline:
    """The doubted labels of one atom in one demonstration: what a person checks in one look at its pictures."""

    demo: str
    atom: Atom
    doubts: tuple[Doubt, ...]

    @property
    def expected(self) -> float:
        """How many of its labels are expected to be wrong."""
        return sum(d.wrong for d in self.doubts)


def doubted(table: TruthTable, predicates: Iterable[Predicate]) -> list[Timeline]:
    """The timelines of ``predicates`` with doubted labels, the most wrong ones first.

    Only values that were asked of a model are doubted, and predicates that are never true have none to compare.
    """
    data = Data(table)
    exact = [p for p in range(data.initial) if not isinstance(data.predicates[p].source, FromVLM)]
    wanted = {p for p in predicates if isinstance(p.source, FromVLM)}
    noisy = [i for i, p in enumerate(data.predicates) if p in wanted]
    if not noisy:
        return []
    repaired = repair(data, partition(data, exact), noisy)
    number = {o: i for i, o in enumerate(data.objects)}
    index = {p: i for i, p in enumerate(data.predicates)}
    found = []
    for d, demo in enumerate(table.demos):
        for column, atom in enumerate(demo.atoms):
            p = index.get(atom.predicate)
            if p is None or p not in repaired.extensions:
                continue
            args = tuple(number[o] for o in atom.objects)
            beliefs = [
                repaired.doubt[p].get((d, s, args), float(args in repaired.extensions[p][d][s]))
                for s in range(len(demo.actions) + 1)
            ]
            if doubts := _doubts(demo, column, beliefs):
                found.append(Timeline(demo.name, atom, doubts))
    return sorted(found, key=lambda t: (-round(t.expected, 6), t.demo, t.atom))


def _doubts(demo: LabelledDemo, column: int, beliefs: Sequence[float]) -> tuple[Doubt, ...]:
    doubts = []
    for state, belief in enumerate(beliefs):
        label = int(demo.values[state, column])
        likely = TRUE if belief > 0.5 else FALSE
        wrong = 1 - belief if label == TRUE else belief if label == FALSE else max(belief, 1 - belief)
        if label != likely and wrong > UNLIKELY:
            doubts.append(Doubt(state, label, likely, wrong))
    return tuple(doubts)
