"""What labels say about an atom along the whole course of a demonstration or episode, errors allowed for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from pix2pred.learning.labels.hidden_markov import HiddenMarkovLabels, LabelPosterior
from pix2pred.learning.operators.robust_settings import RobustSettings
from pix2pred.learning.operators.seen_givens import told_apart
from pix2pred.learning.operators.transition_class import Partition
from pix2pred.learning.transitions import IndexedTable, ObjectIds
from pix2pred.structs import Atom, FromVLM, Predicate, TruthTable


@dataclass(frozen=True)
class Courses:
    """A hidden Markov model per atom, fitted to all demonstrations of a table (``labels/hidden_markov.py``).

    ``noisy`` are the numbers of the predicates whose labels may be wrong; ``classes`` are the transitions, told apart
    by what they do to given atoms.
    """

    data: IndexedTable
    classes: Partition
    noisy: dict[Predicate, int]
    posterior: LabelPosterior

    @classmethod
    def of(cls, table: TruthTable, predicates: Iterable[Predicate]) -> Courses | None:
        """Those of ``predicates`` that a model was asked about; none where nothing was, or all of it is false."""
        data = IndexedTable(table)
        exact = [p for p in range(data.initial) if not isinstance(data.predicates[p].source, FromVLM)]
        wanted = {p for p in predicates if isinstance(p.source, FromVLM)}
        noisy = {p: i for i, p in enumerate(data.predicates) if p in wanted}
        if not noisy:
            return None
        given = [p for p in range(data.initial) if p not in exact]
        classes = told_apart(data, exact, given, RobustSettings())
        return cls(data, classes, noisy, HiddenMarkovLabels().fit(data, classes, list(noisy.values())))

    def number(self, atom: Atom) -> tuple[int, ObjectIds]:
        """The atom of a noisy predicate in numbers."""
        return self.noisy[atom.predicate], tuple(self.data.object_ids[o] for o in atom.objects)

    def beliefs(self, demo: int, atom: Atom) -> list[float] | None:
        """The probability that ``atom`` is true in each state of a demonstration; none for other predicates."""
        if atom.predicate not in self.noisy:
            return None
        p, args = self.number(atom)
        doubtful = self.posterior.belief[p]
        return [
            doubtful.get((demo, s, args), float(args in t)) for s, t in enumerate(self.posterior.extensions[p][demo])
        ]
