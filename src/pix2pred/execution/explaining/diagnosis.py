"""Telling wrong labels from a wrong model, after the fact (method 8.4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from pix2pred.predicates import ground_atoms
from pix2pred.structs import AbstractState, Atom, FromVLM, Task, WorldModel

TruthOf = Callable[[Atom], bool | None]
"""The true value of a visual atom in the environment's present state; None for words without a ground truth."""


def wrong_labels(truth: TruthOf, seen: AbstractState, task: Task, model: WorldModel) -> Mapping[Atom, bool] | None:
    """Visual atoms labelled wrongly, with their true values; ``None`` when some atom has no known truth."""
    errors: dict[Atom, bool] = {}
    visual = [p for p in model.predicates if isinstance(p.source, FromVLM)]
    for atom in ground_atoms(visual, task.objects):
        value = truth(atom)
        if value is None:
            return None
        if value != (atom in seen):
            errors[atom] = value
    return errors


def correct_labels(seen: AbstractState, errors: Mapping[Atom, bool]) -> AbstractState:
    """``seen`` with the wrong labels put right."""
    return frozenset((seen - errors.keys()) | {atom for atom, value in errors.items() if value})
