"""The landmark-cut heuristic for unit costs (Helmert and Domshlak, "Landmarks, critical paths and abstractions", 2009).

With unit costs every cut has cost one, so an operator is either still paid or already free, and h-max is a sequence of
layers: the facts reached with 0, 1, 2, ... paid operators. Layers beyond the goal's are lumped together: which of an
operator's preconditions supports it there changes neither admissibility nor the cut's being a landmark.
"""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.strips import Strips

Edge = tuple[int, int, int]
"""(supporting precondition or 0, add effects, the operator's own bit): an operator in the justification graph."""


class LMCut(Heuristic):
    """Admissible estimate of the plan length from a state; ``None`` for a dead end. Values are remembered."""

    def __init__(self, task: Strips) -> None:
        task = task.without_static_facts()
        self._goal = task.goal
        relaxed = task.relaxed()
        self._operators = [(pre, add, 1 << k) for pre, add, k in relaxed]
        self._free = sum({1 << k for _, _, k in relaxed if k >= len(task.pre)})
        self._known: dict[int, tuple[int, ...] | None] = {}

    def __call__(self, state: int) -> int | None:
        if state not in self._known:
            self._known[state] = self._cuts(state, ())
        return _length(self._known[state])

    def after(self, parent: int, k: int, state: int) -> int | None:
        """The estimate for ``state``, cheaper than from scratch.

        The parent's landmarks without ``k`` are landmarks of the successor as well and are kept (Pommerening and
        Helmert, "Incremental LM-cut", 2013). Where estimates differ, so do ties: both are admissible.
        """
        if state not in self._known:
            kept = tuple(cut for cut in self._known.get(parent) or () if not cut >> k & 1)
            self._known[state] = self._cuts(state, kept)
        return _length(self._known[state])

    def _cuts(self, state: int, landmarks: tuple[int, ...]) -> tuple[int, ...] | None:
        """Disjoint landmarks of ``state``, beginning with ``landmarks``, until the goal costs nothing more."""
        free = self._free
        for landmark in landmarks:
            free |= landmark
        found = list(landmarks)
        while True:
            goal_supporter, edges = self._justify(state, free)
            if goal_supporter is None:
                return None
            if goal_supporter == 0:
                return tuple(found)
            zone = _goal_zone(goal_supporter, [edge for edge in edges if edge[2] & free])
            found.append(_cut(state, zone, edges))
            free |= found[-1]

    def _justify(self, state: int, free: int) -> tuple[int | None, list[Edge]]:
        """The goal's supporter (0: goal reached for nothing, None: never reached) and the justification graph."""
        goal = self._goal
        reached, cheaper = state, 0
        waiting: Sequence[tuple[int, int, int]] = self._operators
        edges: list[Edge] = []
        layer = 0
        while True:
            paid = 0
            changed = True
            while changed:
                changed = False
                missing = ~reached
                still = []
                for operator in waiting:
                    pre, add, bit = operator
                    if pre & missing:
                        still.append(operator)
                        continue
                    supporter = pre & ~cheaper
                    edges.append((supporter & -supporter, add, bit))
                    if bit & free:
                        if add & missing:
                            reached |= add
                            missing = ~reached
                            changed = True
                    else:
                        paid |= add
                waiting = still
            if not goal & ~reached:
                break
            cheaper = reached
            reached |= paid
            layer += 1
            if reached == cheaper:
                return None, edges
        for pre, add, bit in waiting:
            supporter = pre & ~reached
            edges.append((supporter & -supporter, add, bit))
        goal_supporter = goal & ~cheaper if layer else 0
        return goal_supporter & -goal_supporter, edges


def _length(landmarks: tuple[int, ...] | None) -> int | None:
    return None if landmarks is None else len(landmarks)


def _goal_zone(goal_supporter: int, free_edges: list[Edge]) -> int:
    """Facts from which the goal's supporter follows for nothing in the justification graph."""
    zone = goal_supporter
    grown = True
    while grown:
        grown = False
        for supporter, add, _ in free_edges:
            if add & zone and not supporter & zone:
                zone |= supporter
                grown = True
    return zone


def _cut(state: int, zone: int, edges: list[Edge]) -> int:
    """Operators that lead from the state's side of the justification graph into the goal zone."""
    before = state
    cut = 0
    waiting = edges
    grown = True
    while grown:
        grown = False
        still = []
        for edge in waiting:
            supporter, add, bit = edge
            if supporter and not supporter & before:
                still.append(edge)
                continue
            if add & zone:
                cut |= bit
            if add & ~zone & ~before:
                before |= add & ~zone
                grown = True
        waiting = still
    return cut
