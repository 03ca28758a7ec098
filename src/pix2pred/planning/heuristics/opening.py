"""When operators can first be taken if nothing is ever deleted, layer by layer."""

from __future__ import annotations

from collections.abc import Sequence
from operator import itemgetter

Way = tuple[int, int, int]
"""Preconditions, what is added besides them, and the number of the way."""

SCANNED = 6
"""Layers in which all ways that wait are looked at. In later ones they are looked at when a fact is reached that they
lack, which costs more for each way, and nothing for layers that add little: tasks of a thousand layers have few ways in
each. Chosen by judgement: no other number was tried."""


class Opening:
    """Gives the ways that open in each layer, in the order of their numbers."""

    def __init__(self, ways: Sequence[Way]) -> None:
        self._waiting = ways
        self._watching: dict[int, list[Way]] = {}
        self._scans = SCANNED

    def layer(self, missing: int, new: int) -> list[Way]:
        """The ways without preconditions among the facts ``missing`` that were not given before.

        ``new`` are the facts that have become true since the last layer.
        """
        ready: list[Way] = []
        if self._scans:
            self._scans -= 1
            still: list[Way] = []
            for way in self._waiting:
                (still if way[0] & missing else ready).append(way)
            self._waiting = still
            return ready
        for way in self._waiting:
            self._place(way, missing, ready)
        self._waiting = ()
        while new:
            fact = new & -new
            new ^= fact
            for way in self._watching.pop(fact, ()):
                self._place(way, missing, ready)
        ready.sort(key=itemgetter(2))
        return ready

    def _place(self, way: Way, missing: int, ready: list[Way]) -> None:
        """Put ``way`` among those that are open, or let it wait for one of the facts that it lacks."""
        if lacking := way[0] & missing:
            self._watching.setdefault(lacking & -lacking, []).append(way)
        else:
            ready.append(way)
