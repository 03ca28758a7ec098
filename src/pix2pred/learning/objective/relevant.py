"""The part of a ground task that can matter, numbered anew, so that tasks that differ in nothing else become equal."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.planning.strips import Strips, bits
from pix2pred.structs import Type

GroundBits = tuple[int, int, int]
"""Preconditions, add effects and delete effects of a ground operator, as bits."""


def relevant_task(
    operators: Sequence[GroundBits],
    initial: int,
    goal: int,
    atoms: Sequence[tuple[int, ...]] = (),
    kinds: Sequence[Type] = (),
) -> Strips | None:
    """The reachable part of a task without the facts that cannot matter; ``None`` if the goal is unreachable.

    Drops operators with preconditions that even a delete-free execution never reaches, facts that hold throughout,
    and facts in no precondition or goal; renumbers what is left. No plan is gained or lost. ``atoms`` tells what facts
    are about, by their bits, and ``kinds`` of which types their objects are.
    """
    reached = initial
    waiting: Sequence[GroundBits] = operators
    used: list[GroundBits] = []
    grown = True
    while grown:
        still = []
        missing = ~reached
        for operator in waiting:
            if operator[0] & missing:
                still.append(operator)
            else:
                used.append(operator)
                reached |= operator[1]
        waiting = still
        grown = bool(reached & missing)
    if goal & ~reached:
        return None
    wanted = goal
    deleted = 0
    for pre, _, delete in used:
        wanted |= pre
        deleted |= delete
    relevant = wanted & ~(initial & ~deleted)
    compact = _Compactor(relevant)
    projected = sorted((compact(pre), compact(add), compact(delete)) for pre, add, delete in used)
    return Strips(
        compact.size,
        tuple(o[0] for o in projected),
        tuple(o[1] for o in projected),
        tuple(o[2] for o in projected),
        compact(initial),
        compact(goal),
        atoms=tuple([atoms[i] for i in bits(relevant)]) if atoms else (),
        kinds=tuple(kinds),
    )


class _Compactor:
    """Projects bit sets onto the set bits of a mask, renumbered from zero."""

    def __init__(self, mask: int) -> None:
        self._mask = mask
        self._positions: dict[int, int] = {}
        while mask:
            low = mask & -mask
            self._positions[low] = 1 << len(self._positions)
            mask ^= low
        self._known: dict[int, int] = {0: 0}

    @property
    def size(self) -> int:
        return len(self._positions)

    def __call__(self, value: int) -> int:
        value &= self._mask
        if value not in self._known:
            rest, result = value, 0
            while rest:
                low = rest & -rest
                result |= self._positions[low]
                rest ^= low
            self._known[value] = result
        return self._known[value]
