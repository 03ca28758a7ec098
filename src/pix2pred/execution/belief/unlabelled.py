"""Atoms about which a look says nothing."""

from __future__ import annotations

from pix2pred.predicates import StateLabels
from pix2pred.predicates.prompt import atom_text
from pix2pred.structs import Atom, Label


def unlabelled(labels: StateLabels) -> tuple[Atom, ...]:
    """The atoms of ``labels`` without a value, or whose value is unknown, sorted."""
    without = {text for gap in labels.gaps for text in gap.atoms}
    return tuple(sorted(a for a, v in labels.values.items() if v == Label.UNKNOWN or atom_text(a) in without))
