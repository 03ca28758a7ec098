"""The learned model: predicates and operators (method 6.4)."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.structs.demos import Vocabulary
from pix2pred.structs.knowledge import Invariant, Reliability
from pix2pred.structs.operators import Operator
from pix2pred.structs.predicates import Predicate


@dataclass(frozen=True, slots=True)
class WorldModel:
    """Initial predicates (in the vocabulary), the selected ones, and operators learned over their union.

    ``labels_from`` names the model that labelled the demonstrations, e.g. ``offline`` or ``oracle``. ``reliability``
    and ``invariants`` are what acting on uncertain labels rests on; models of before have neither.
    """

    vocabulary: Vocabulary
    selected: tuple[Predicate, ...]
    operators: tuple[Operator, ...]
    labels_from: str
    reliability: tuple[Reliability, ...] = ()
    invariants: tuple[Invariant, ...] = ()

    @property
    def predicates(self) -> tuple[Predicate, ...]:
        """Initial and selected predicates, sorted."""
        return tuple(sorted({*self.vocabulary.initial, *self.selected}))
