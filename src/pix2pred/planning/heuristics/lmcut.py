"""The landmark-cut heuristic for unit costs (Helmert and Domshlak, "Landmarks, critical paths and abstractions", 2009).

With unit costs every cut has cost one, so an operator is either still paid or already free, and h-max is a sequence of
layers: the facts reached with 0, 1, 2, ... paid operators. Layers beyond the goal's are lumped together: which of an
operator's preconditions supports it there changes neither admissibility nor the cut's being a landmark.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.strips import Strips

Way = tuple[int, int, int, "Edge"]
"""How facts become true: preconditions, add effects, the operator's bit, its edge where the preconditions are free."""

Edge = tuple[int, int, int]
"""(supporting precondition or 0, add effects, the operator's own bit): an operator in the justification graph."""

Landmark = tuple[int, tuple[Way, ...]]
"""The operators of a landmark as bits, and their ways."""


class LMCut(Heuristic):
    """Admissible estimate of the plan length from a state; ``None`` for a dead end. Values are remembered."""

    def __init__(self, task: Strips) -> None:
        task = task.without_static_facts()
        self._goal = task.goal
        relaxed = task.relaxed()
        self._ways: list[Way] = [(pre, add, 1 << k, (pre & -pre, add, 1 << k)) for pre, add, k in relaxed]
        self._free = tuple([way for way in self._ways if way[2] >= 1 << len(task.pre)])
        self._of_operator: dict[int, list[Way]] = defaultdict(list)
        for way in self._ways:
            self._of_operator[way[2]].append(way)
        self._known: dict[int, tuple[Landmark, ...] | None] = {}

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
            kept = tuple([cut for cut in self._known.get(parent) or () if not cut[0] >> k & 1])
            self._known[state] = self._cuts(state, kept)
        return _length(self._known[state])

    def _cuts(self, state: int, landmarks: tuple[Landmark, ...]) -> tuple[Landmark, ...] | None:
        """Disjoint landmarks of ``state``, beginning with ``landmarks``, until the goal costs nothing more.

        What is reached for nothing grows from landmark to landmark, and is reached by free operators alone: only where
        that is not the goal are all operators looked at.
        """
        found = list(landmarks)
        free = sum([way[2] for way in self._free])
        waiting = list(self._free)
        for operators, ways in landmarks:
            free |= operators
            waiting += ways
        reached = state
        while True:
            reached, waiting = _reach(reached, waiting)
            if not self._goal & ~reached:
                return tuple(found)
            goal_supporter, edges = self._justify(reached, waiting)
            if goal_supporter is None:
                return None
            zone = _goal_zone(goal_supporter, [edge for edge in edges if edge[2] & free])
            cut = _cut(state, zone, edges)
            found.append((sum(cut), tuple([way for operator in cut for way in self._of_operator[operator]])))
            free |= found[-1][0]
            waiting += found[-1][1]

    def _justify(self, reached: int, free: Sequence[Way]) -> tuple[int | None, list[Edge]]:
        """The goal's supporter (None: never reached) and the justification graph.

        ``reached`` is what is reached for nothing, which is not the goal; ``free`` are free ways not yet usable there.
        """
        goal = self._goal
        missing = ~reached
        paid = 0
        edges = []
        waiting = []
        for way in self._ways:
            if way[0] & missing:
                waiting.append(way)
            else:
                edges.append(way[3])
                paid |= way[1]
        while True:
            cheaper = reached
            reached, free = _reach(reached | paid, free)
            if reached == cheaper:
                return None, edges
            missing = ~reached
            if not goal & missing:
                break
            still = []
            for way in waiting:
                pre, add, bit, _ = way
                if pre & missing:
                    still.append(way)
                else:
                    supporter = pre & ~cheaper
                    edges.append((supporter & -supporter, add, bit))
                    paid |= add
            waiting = still
        dearer = ~cheaper
        for pre, add, bit, _ in waiting:
            supporter = pre & missing or pre & dearer
            edges.append((supporter & -supporter, add, bit))
        goal_supporter = goal & dearer
        return goal_supporter & -goal_supporter, edges


def _reach(reached: int, waiting: Sequence[Way]) -> tuple[int, list[Way]]:
    """What is reached from ``reached`` by ``waiting``, and those of them whose preconditions are not."""
    grown = True
    while grown:
        missing = ~reached
        still = []
        for way in waiting:
            if way[0] & missing:
                still.append(way)
            else:
                reached |= way[1]
        grown = bool(reached & missing)
        waiting = still
    return reached, list(waiting)


def _length(landmarks: tuple[Landmark, ...] | None) -> int | None:
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


def _cut(state: int, zone: int, edges: list[Edge]) -> list[int]:
    """Bits of the operators that lead from the state's side of the justification graph into the goal zone."""
    before = state
    cut = set()
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
                cut.add(bit)
            if add & ~zone & ~before:
                before |= add & ~zone
                grown = True
        waiting = still
    return sorted(cut)
