"""Which operators can be taken in a state. The preconditions of all are looked up at once, by numpy."""

from __future__ import annotations

import numpy as np

from pix2pred.planning.heuristics.columns import by_width
from pix2pred.planning.strips import Strips


class Successors:
    """Gives the numbers of the operators that can be taken in a state of ``task``, ascending."""

    def __init__(self, task: Strips) -> None:
        task = task.without_static_facts()
        self._size = -(-task.facts // 8)
        order = sorted(range(len(task.pre)), key=lambda k: task.pre[k].bit_count())
        self._order = np.array(order, np.intp)
        self._columns = by_width([task.pre[k] for k in order])

    def __call__(self, state: int) -> list[int]:
        facts = np.unpackbits(np.frombuffer(state.to_bytes(self._size, "little"), np.uint8), bitorder="little")
        can = np.ones(len(self._order), np.uint8)
        for place, columns in self._columns:
            here = can[place : place + len(columns[0])]
            for column in columns:
                here &= facts.take(column, mode="clip")
        found = self._order[np.flatnonzero(can)]
        found.sort()
        return list(map(int, found.tolist()))
