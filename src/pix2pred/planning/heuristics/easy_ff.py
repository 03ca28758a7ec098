"""The FF heuristic with the easiest achievers (Hoffmann and Nebel, "The FF planning system", 2001, section 4.2.2).

Of all operators that achieve a fact in the first layer that has it, the one is taken whose preconditions stand in the
earliest layers in sum. Relaxed plans get shorter and tell more, where facts have many achievers.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from functools import partial

from pix2pred.planning.heuristics.ff import FF
from pix2pred.planning.strips import Strips, bits


class EasyFF(FF):
    """Length of a delete-free plan of easy operators. Preferred are the operators of that plan that apply at once."""

    def __init__(self, task: Strips) -> None:
        super().__init__(task)
        self._adding: dict[int, list[int]] = defaultdict(list)
        for way, (_, add, _) in enumerate(self._ways):
            for fact in bits(add):
                self._adding[fact].append(way)

    def _achievers(self, state: int) -> Callable[[int], int] | None:
        layers = self._layers(state)
        return None if layers is None else partial(self._easiest, layers)

    def _layers(self, state: int) -> list[int] | None:
        """The facts reached after 0, 1, 2, ... layers of operators; ``None`` when the goal is never among them."""
        layers = [state]
        waiting = self._ways
        while self._goal & ~layers[-1]:
            missing = ~layers[-1]
            reached = layers[-1]
            still = []
            for way in waiting:
                if way[0] & missing:
                    still.append(way)
                else:
                    reached |= way[1]
            if reached == layers[-1]:
                return None
            layers.append(reached)
            waiting = still
        return layers

    def _easiest(self, layers: list[int], fact: int) -> int:
        """The easiest way to ``fact`` among those that are open in the layer before its first."""
        bit = 1 << fact
        level = next(i for i, layer in enumerate(layers) if layer & bit)
        missing = ~layers[level - 1]
        best, least = -1, -1
        for way in self._adding[fact]:
            pre = self._ways[way][0]
            if pre & missing:
                continue
            difficulty = sum((pre & ~layer).bit_count() for layer in layers[: level - 1])
            if best < 0 or difficulty < least:
                best, least = way, difficulty
                if not difficulty:
                    break
        return best
