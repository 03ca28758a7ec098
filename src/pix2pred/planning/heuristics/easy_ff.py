"""The FF heuristic with the easiest achievers (Hoffmann and Nebel, "The FF planning system", 2001, section 4.2.2).

Of all operators that achieve a fact in the first layer that has it, the one is taken whose preconditions stand in the
earliest layers in sum. Relaxed plans get shorter and tell more, where facts have many achievers.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from functools import partial

from pix2pred.planning.heuristics.ff import FF
from pix2pred.planning.heuristics.opening import Opening
from pix2pred.planning.strips import Strips, bits


class EasyFF(FF):
    """Length of a delete-free plan of easy operators. Preferred are the operators of that plan that apply at once."""

    def __init__(self, task: Strips) -> None:
        super().__init__(task)
        self._adding: dict[int, list[int]] = defaultdict(list)
        for way, (_, add, _) in enumerate(self._ways):
            for fact in bits(add):
                self._adding[fact].append(way)

        self._pre = [tuple(bits(pre)) for pre, _, _ in self._ways]

    def _achievers(self, state: int) -> Callable[[int], int] | None:
        level = self._levels(state)
        return None if level is None else partial(self._easiest, level)

    def _levels(self, state: int) -> dict[int, int] | None:
        """The layers in which facts are reached, 0 where they hold; ``None`` when the goal is in none of them."""
        level = dict.fromkeys(bits(state), 0)
        reached, new = state, 0
        opening = Opening(self._operators)
        layer = 0
        while self._goal & ~reached:
            before = reached
            for _, add, _ in opening.layer(~before, new):
                reached |= add
            new = reached & ~before
            if not new:
                return None
            layer += 1
            for fact in bits(new):
                level[fact] = layer
        return level

    def _easiest(self, level: dict[int, int], fact: int) -> int:
        """The easiest way to ``fact`` among those that are open in the layer before its first."""
        before = level[fact] - 1
        best, least = -1, -1
        for way in self._adding[fact]:
            levels = [level.get(p, before + 1) for p in self._pre[way]]
            if levels and max(levels) > before:
                continue
            difficulty = sum(levels)
            if best < 0 or difficulty < least:
                best, least = way, difficulty
                if not difficulty:
                    break
        return best
