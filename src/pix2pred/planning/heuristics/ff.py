"""The FF heuristic and its helpful operators (Hoffmann and Nebel, "The FF planning system", 2001)."""

from __future__ import annotations

from collections.abc import Callable

from pix2pred.planning.heuristics.heuristic import Evaluation, Heuristic
from pix2pred.planning.heuristics.opening import Opening
from pix2pred.planning.strips import Strips, bits


class FF(Heuristic):
    """Length of a delete-free plan from a state. Preferred are the operators of that plan that apply at once.

    Every fact is achieved by the first operator that reaches it.
    """

    def __init__(self, task: Strips) -> None:
        task = task.without_static_facts()
        self._goal = task.goal
        self._ways = task.relaxed()
        self._operators = [(pre, add, way) for way, (pre, add, _) in enumerate(self._ways)]
        self._count = len(task.pre)

    def __call__(self, state: int) -> int | None:
        found = self.evaluate(state)
        return None if found is None else found.estimate

    def evaluate(self, state: int) -> Evaluation | None:
        achiever = self._achievers(state)
        if achiever is None:
            return None
        used: set[int] = set()
        plan: set[int] = set()
        helpful = 0
        open_facts = list(bits(self._goal & ~state))
        wanted = self._goal
        while open_facts:
            way = achiever(open_facts.pop())
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

    def _achievers(self, state: int) -> Callable[[int], int] | None:
        """What tells the operator that achieves a fact; ``None`` when the goal cannot be reached from ``state``."""
        reached, new = state, 0
        achiever: dict[int, int] = {}
        opening = Opening(self._operators)
        while self._goal & ~reached:
            before = reached
            for _, add, way in opening.layer(~before, new):
                for fact in bits(add & ~reached):
                    achiever[fact] = way
                reached |= add
            new = reached & ~before
            if not new:
                return None
        return achiever.__getitem__
