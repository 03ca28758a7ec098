"""Labels of ground atoms along demonstrations as arrays: one row per atom, one column per state."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning.operators.roles import Roles
from pix2pred.learning.transitions import IndexedTable, ObjectIds

Ints = NDArray[np.int64]

NO_LABEL = -1
"""Beside 0 (false) and 1 (true): unknown, or a state after the demonstration's last."""


@dataclass(frozen=True, slots=True)
class Chains:
    """Labels of some predicates' ground atoms, and the roles of these atoms in the transitions.

    Row i is about atom ``where[i]``, given as (demonstration, objects), of predicate ``predicates[owner[i]]``; rows of
    a predicate are together. ``labels`` has shape (atoms, states) and holds 0, 1 or ``NO_LABEL``; ``roles`` has shape
    (atoms, states - 1), and role 0 where there is no transition.
    """

    predicates: list[int]
    owner: Ints
    where: list[tuple[int, ObjectIds]]
    labels: NDArray[np.int8]
    roles: NDArray[np.int32]

    def in_demonstration(self) -> NDArray[np.bool_]:
        """Which cells of ``labels`` belong to a state of a demonstration: the first, and those beside a transition."""
        is_transition = self.roles > 0
        inside = np.zeros(self.labels.shape, dtype=bool)
        inside[:, 0] = True
        inside[:, :-1] |= is_transition
        inside[:, 1:] |= is_transition
        return inside


def blocks(data: IndexedTable, roles: Roles, predicates: Sequence[int], cells: int) -> Iterator[Chains]:
    """Chains of ``predicates``, whole predicates together, in blocks of about ``cells`` labels."""
    states = max((demo.states for demo in data.demos), default=0)
    rows: list[tuple[int, int, ObjectIds]] = []
    for p in predicates:
        for d, demo in enumerate(data.demos):
            atoms = roles.touched(d, p).union(*(data.extension(d, s, p) for s in range(demo.states)))
            atoms |= set().union(*(data.unknown(d, s, p) for s in range(demo.states)))
            rows.extend((p, d, args) for args in sorted(atoms))
        if len(rows) * states >= cells:
            yield _chains(data, roles, rows, states)
            rows = []
    if rows:
        yield _chains(data, roles, rows, states)


def _chains(data: IndexedTable, roles: Roles, rows: Sequence[tuple[int, int, ObjectIds]], states: int) -> Chains:
    predicates = sorted({p for p, _, _ in rows})
    number = {p: i for i, p in enumerate(predicates)}
    labels = np.full((len(rows), states), NO_LABEL, dtype=np.int8)
    in_role = np.zeros((len(rows), max(states - 1, 0)), dtype=np.int32)
    index = {row: i for i, row in enumerate(rows)}
    for i, (p, d, args) in enumerate(rows):
        labels[i, : data.demos[d].states] = 0
        in_role[i, : data.demos[d].states - 1] = roles.row(d, args, p)
    for p in predicates:
        for d, demo in enumerate(data.demos):
            for s in range(demo.states):
                for args in data.extension(d, s, p):
                    labels[index[p, d, args], s] = 1
                for args in data.unknown(d, s, p):
                    labels[index[p, d, args], s] = NO_LABEL
    owner = np.array([number[p] for p, _, _ in rows], dtype=np.int64)
    return Chains(predicates, owner, [(d, args) for _, d, args in rows], labels, in_role)
