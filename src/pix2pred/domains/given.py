"""Given atoms of a simulated domain: which of them hold in a world."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from pix2pred.structs import Atom, Object, Predicate, groundings


def holding(
    predicates: Iterable[Predicate], objects: Sequence[Object], holds: Callable[[Atom], bool]
) -> frozenset[Atom]:
    """The atoms of ``predicates`` for which ``holds``, over all type-consistent groundings with distinct objects."""
    return frozenset(
        atom
        for predicate in predicates
        for args in groundings(predicate.types, objects, distinct=True)
        if holds(atom := Atom(predicate, args))
    )
