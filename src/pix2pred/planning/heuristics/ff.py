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
        found = self._plan(state)
        return None if found is None else Evaluation(len(found[0]), found[1])

    def relaxed_plan(self, state: int) -> list[int] | None:
        """The operators of the delete-free plan from ``state``, those that others need rather before them."""
        found = self._plan(state)
        return None if found is None else list(reversed(found[0]))

    def _plan(self, state: int) -> tuple[dict[int, None], int] | None:
        """A delete-free plan, from the goal backwards, and as bits those of its operators that apply at once."""
        achiever = self._achievers(state)
        if achiever is None:
            return None
        used: set[int] = set()
        plan: dict[int, None] = {}
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
                plan[k] = None
                if not needs:
                    helpful |= 1 << k
            open_facts.extend(bits(needs & ~wanted))
            wanted |= needs
        return plan, helpful

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
