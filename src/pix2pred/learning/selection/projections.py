"""Predicates that say less than another: "the jug is in some machine" beside "the jug is in this machine"."""

from __future__ import annotations

from itertools import permutations

from pix2pred.learning.transitions import IndexedTable


def is_projection(data: IndexedTable, coarse: int, fine: int) -> bool:
    """Whether ``coarse`` is true of exactly those objects for which others make ``fine`` true, in every state."""
    types, wider = data.predicates[coarse].types, data.predicates[fine].types
    if not len(types) < len(wider):
        return False
    return any(
        all(wider[i].is_a(t) for i, t in zip(places, types, strict=True)) and _agrees(data, coarse, fine, places)
        for places in permutations(range(len(wider)), len(types))
    )


def _agrees(data: IndexedTable, coarse: int, fine: int, places: tuple[int, ...]) -> bool:
    return all(
        data.extension(d, s, coarse) == {tuple(args[i] for i in places) for args in data.extension(d, s, fine)}
        for d, demo in enumerate(data.demos)
        for s in range(demo.states)
    )
