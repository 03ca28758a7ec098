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

    Row i is about the atoms ``where[i]``, given as (demonstration, objects), of predicate ``predicates[owner[i]]``: all
    that have these labels and roles, ``weight[i]`` in number. Rows of a predicate are together. ``labels`` has shape
    (rows, states) and holds 0, 1 or ``NO_LABEL``; ``roles`` has shape (rows, states - 1), and role 0 where there is no
    transition.
    """

    predicates: list[int]
    owner: Ints
    where: list[list[tuple[int, ObjectIds]]]
    weight: NDArray[np.float64]
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
    first, where = _alike(rows, owner, labels, in_role)
    weight = np.array([len(atoms) for atoms in where], dtype=np.float64)
    return Chains(predicates, owner[first], where, weight, labels[first], in_role[first])


def _alike(
    rows: Sequence[tuple[int, int, ObjectIds]], owner: Ints, labels: NDArray[np.int8], in_role: NDArray[np.int32]
) -> tuple[Ints, list[list[tuple[int, ObjectIds]]]]:
    """The first of every kind of row, and the atoms of all rows of its kind."""
    kinds: dict[tuple[int, bytes, bytes], int] = {}
    first: list[int] = []
    where: list[list[tuple[int, ObjectIds]]] = []
    for i, (_, d, args) in enumerate(rows):
        key = (int(owner[i]), labels[i].tobytes(), in_role[i].tobytes())
        kind = kinds.setdefault(key, len(first))
        if kind == len(first):
            first.append(i)
            where.append([])
        where[kind].append((d, args))
    return np.array(first, dtype=np.int64), where
