"""``selection.json``: what selection gave, in the form the traces format promises."""

from __future__ import annotations

from typing import Any

from pix2pred.learning.selection.result import ClimbStep, Selection
from pix2pred.learning.settings import LearningSettings
from pix2pred.structs.formats.writing import operator_doc

DIGITS = 4
"""Decimals of J: fewer than the last bits in which machines may differ."""


def selection_document(selection: Selection, settings: LearningSettings) -> dict[str, Any]:
    """The JSON form of a selection. Equal inputs give equal documents on any machine."""
    return {
        "selected": [p.name for p in selection.selected],
        "steps": [_step(step) for step in selection.steps],
        "end": selection.end.value,
        "pinned": [p.name for p in selection.pinned],
        "dropped": [p.name for p in selection.dropped],
        "identical_columns": {p.name: [q.name for q in others] for p, others in selection.identical},
        "operators": [operator_doc(op) for op in selection.operators],
        "evaluations": selection.evaluations,
        "budget_hits": selection.budget_hits,
        "settings": settings.model_dump(mode="json"),
    }


def _step(step: ClimbStep) -> dict[str, Any]:
    return {
        "added": step.added.name if step.added else None,
        "J": round(step.j, DIGITS),
        "J_demos": [None if j is None else round(j, DIGITS) for j in step.j_demos],
        "runners_up": [
            {"predicate": r.predicate.name, "J": round(r.j, DIGITS), "lower_bound": not r.exact}
            for r in step.runners_up
        ],
    }
