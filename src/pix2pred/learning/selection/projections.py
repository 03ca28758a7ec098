"""Predicates that follow from another one: "the jug is in some machine" from "the jug is in this machine", "the lid is
open" from "the lid is closed"."""

from __future__ import annotations

from itertools import permutations

from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs.objects import count_groundings


def is_projection(data: IndexedTable, coarse: int, fine: int) -> bool:
    """Whether ``coarse`` is true of exactly those objects for which others make ``fine`` true, in every state."""
    types, wider = data.predicates[coarse].types, data.predicates[fine].types
    if not len(types) < len(wider):
        return False
    return any(
        all(wider[i].is_a(t) for i, t in zip(places, types, strict=True)) and _agrees(data, coarse, fine, places)
        for places in permutations(range(len(wider)), len(types))
    )


def is_contrary(data: IndexedTable, one: int, other: int, errors: float) -> bool:
    """Whether either of two predicates holds where the other does not, but for a share ``errors`` of all values."""
    types = data.predicates[one].types
    if types != data.predicates[other].types:
        return False
    atoms = equal = 0
    for d, demo in enumerate(data.demos):
        here = count_groundings(types, [data.objects[o] for o in demo.objects], distinct=True)
        for s in range(demo.states):
            atoms += here
            equal += here - len(data.extension(d, s, one) ^ data.extension(d, s, other))
    return equal <= errors * atoms


def _agrees(data: IndexedTable, coarse: int, fine: int, places: tuple[int, ...]) -> bool:
    return all(
        data.extension(d, s, coarse) == {tuple(args[i] for i in places) for args in data.extension(d, s, fine)}
        for d, demo in enumerate(data.demos)
        for s in range(demo.states)
    )
