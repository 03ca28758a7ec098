"""The FF heuristic with the easiest achievers (Hoffmann and Nebel, "The FF planning system", 2001, section 4.2.2).

Of all operators that achieve a fact in the first layer that has it, the one is taken whose preconditions stand in the
earliest layers in sum. Relaxed plans get shorter and tell more, where facts have many achievers.
"""

from __future__ import annotations

from collections import defaultdict

from pix2pred.planning.heuristics.heuristic import Evaluation, Heuristic
from pix2pred.planning.strips import Strips, bits


class EasyFF(Heuristic):
    """Length of a delete-free plan of easy operators. Preferred are the operators of that plan that apply at once."""

    def __init__(self, task: Strips) -> None:
        task = task.without_static_facts()
        self._goal = task.goal
        self._ways = task.relaxed()
        self._count = len(task.pre)
        self._adding: dict[int, list[int]] = defaultdict(list)
        for way, (_, add, _) in enumerate(self._ways):
            for fact in bits(add):
                self._adding[fact].append(way)

    def __call__(self, state: int) -> int | None:
        found = self.evaluate(state)
        return None if found is None else found.estimate

    def evaluate(self, state: int) -> Evaluation | None:
        layers = self._layers(state)
        if layers is None:
            return None
        used: set[int] = set()
        plan: set[int] = set()
        helpful = 0
        open_facts = list(bits(self._goal & ~state))
        wanted = self._goal
        while open_facts:
            way = self._easiest(open_facts.pop(), layers)
            if way in used:
                continue
            used.add(way)
            pre, _, k = self._ways[way]
            needs = pre & ~state
            if k < self._count:
                plan.add(k)
                if not needs:
                    helpful |= 1 << k
            open_facts.extend(bits(needs & ~wanted))
            wanted |= needs
        return Evaluation(len(plan), helpful)

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

    def _easiest(self, fact: int, layers: list[int]) -> int:
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
