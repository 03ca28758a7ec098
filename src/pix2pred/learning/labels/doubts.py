"""Which labels are probably wrong: where the given labels disagree with the most probable values along demonstrations.

The beliefs are those of a hidden Markov model per ground atom (``labels/hidden_markov.py``), fitted to all
demonstrations. A wrong label matters when its predicate does: for the operators at hand, or for those that would be
learned if labels were right.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

from pix2pred.learning.labels.hidden_markov import HiddenMarkovLabels
from pix2pred.learning.operators.robust_settings import RobustSettings
from pix2pred.learning.operators.seen_givens import told_apart
from pix2pred.learning.operators.transition_class import TransitionClass
from pix2pred.learning.transitions import IndexedTable, ObjectIds
from pix2pred.structs import (
    Atom,
    FromVLM,
    Label,
    LabelledDemo,
    Predicate,
    TruthTable,
)

UNLIKELY = 0.5
"""Labels that are wrong with a higher probability are doubted."""

RARE = 0.3
"""A label is unusual when at most this share of its kind have its value. Chosen by hand: a share above it would call
half of a mixed column unusual."""


@dataclass(frozen=True, slots=True)
class Doubt:
    """A label that is wrong with probability ``wrong`` if ``likely`` is the true value."""

    state: int
    label: Label
    likely: Label
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


def doubted(table: TruthTable, predicates: Iterable[Predicate], *, unusual: bool = False) -> list[Timeline]:
    """The timelines of ``predicates`` with doubted labels, the most wrong ones first.

    ``unusual`` also doubts labels that differ from most of those that the same kind of transition has at the same
    place: errors in the first state, which a course cannot tell from effects, but which break unanimous operators.

    Only values that were asked of a model are doubted, and predicates that are never true have none to compare.
    """
    data = IndexedTable(table)
    exact = [p for p in range(data.initial) if not isinstance(data.predicates[p].source, FromVLM)]
    wanted = {p for p in predicates if isinstance(p.source, FromVLM)}
    noisy = [i for i, p in enumerate(data.predicates) if p in wanted]
    if not noisy:
        return []
    given = [p for p in range(data.initial) if p not in exact]
    classes = told_apart(data, exact, given, RobustSettings())
    posterior = HiddenMarkovLabels().fit(data, classes, noisy)
    rare = _unusual(data, classes, noisy) if unusual else {}
    number = {o: i for i, o in enumerate(data.objects)}
    index = {p: i for i, p in enumerate(data.predicates)}
    found = []
    for d, demo in enumerate(table.demos):
        for column, atom in enumerate(demo.atoms):
            p = index.get(atom.predicate)
            if p is None or p not in posterior.extensions:
                continue
            args = tuple(number[o] for o in atom.objects)
            states = range(len(demo.actions) + 1)
            beliefs = [
                posterior.belief[p].get((d, s, args), float(args in posterior.extensions[p][d][s])) for s in states
            ]
            usual = [rare.get((p, d, s, args)) for s in states]
            if doubts := _doubts(demo, column, beliefs, usual):
                found.append(Timeline(demo.name, atom, doubts))
    return sorted(found, key=lambda t: (-round(t.expected, 6), t.demo, t.atom))


def _doubts(
    demo: LabelledDemo, column: int, beliefs: Sequence[float], usual: Sequence[float | None]
) -> tuple[Doubt, ...]:
    """Doubted labels, given the probability that each atom is true and, where it is unusual, how often it is usual."""
    doubts = []
    for state, belief in enumerate(beliefs):
        label = Label(demo.values[state, column])
        likely = Label.of(belief > 0.5)
        wrong = max(belief, 1 - belief)
        rarity = usual[state]
        if label == likely and rarity is not None:
            likely, wrong = Label.of(label is Label.FALSE), rarity
        if label != likely and wrong > UNLIKELY:
            doubts.append(Doubt(state, label, likely, wrong))
    return tuple(doubts)


def _unusual(
    data: IndexedTable, classes: Sequence[TransitionClass], noisy: Sequence[int]
) -> dict[tuple[int, int, int, ObjectIds], float]:
    """Labels unlike most at their place, by (predicate, demonstration, state, arguments), with the share of the others.

    A place is a kind of transition, before or after it, and the variables that the arguments stand for.
    """
    found: dict[tuple[int, int, int, ObjectIds], float] = {}
    for cls in classes:
        for p in noisy:
            types = data.predicates[p].types
            domains = [[v for v, t in enumerate(cls.types) if t.is_a(wanted)] for wanted in types]
            for variables in product(*domains):
                for offset in (0, 1):
                    where = []
                    for m in cls.members:
                        tr = data.transitions[m.transition]
                        where.append((tr.demo, tr.step + offset, tuple(m.objects[v] for v in variables)))
                    held = [args in data.extension(d, s, p) for d, s, args in where]
                    share = (sum(held) + 0.5) / (len(held) + 1)
                    if len(set(variables)) < len(variables) or not 0 < min(share, 1 - share) <= RARE:
                        continue
                    for (d, s, args), value in zip(where, held, strict=True):
                        if value != (share > 0.5):
                            key = (p, d, s, args)
                            found[key] = max(found.get(key, 0.0), max(share, 1 - share))
    return found
