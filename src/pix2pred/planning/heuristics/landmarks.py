"""Landmarks: facts that every plan makes true, and how many of them are still to be reached.

All landmarks that the task has without deletes are found by propagating them through operators (Zhu and Givan,
"Landmark extraction via planning graph propagation", 2003; Keyder, Richter and Helmert, "Sound and complete landmarks
for and/or graphs", 2010). They are counted along a path as in LAMA (Richter and Westphal, 2010): one that was reached
and lost counts again when it is a goal, or must hold directly before another that is still to be reached.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from pix2pred.planning.strips import Relaxed, Strips, bits


class LandmarkCount:
    """Counts the landmarks of ``task`` that are to be reached. Sets of landmarks are bits, those of their facts."""

    def __init__(self, task: Strips) -> None:
        ways = task.relaxed()
        needed = _propagated(task.initial, ways)
        self.all = task.goal
        for fact in bits(task.goal):
            self.all |= needed.get(fact, 0)
        self._goal = task.goal
        self._before = {1 << fact: needed.get(fact, 0) & ~(1 << fact) for fact in bits(self.all)}
        directly = self._conditions(task.initial, ways, needed)
        self._enables: dict[int, int] = defaultdict(int)
        for landmark, conditions in directly.items():
            for fact in _single(conditions):
                self._enables[fact] |= landmark
        self._missed = self._goal | sum(fact for fact in self._enables if fact & self.all)

    def _conditions(self, initial: int, ways: Sequence[Relaxed], needed: dict[int, int]) -> dict[int, int]:
        """What must hold directly before each landmark: what all ways need that can be the first to reach it."""
        directly = dict.fromkeys(self._before, -1)
        for pre, add, _ in ways:
            wanted = add & self.all
            if wanted:
                through = pre
                for fact in bits(pre):
                    through |= needed.get(fact, 0)
                for fact in bits(wanted & ~through):
                    directly[1 << fact] &= pre
        return {fact: 0 if fact & initial or conditions < 0 else conditions for fact, conditions in directly.items()}

    def reached(self, before: int, state: int) -> int:
        """The landmarks reached on the way to ``state``; ``before`` are those reached on the way to the one before.

        A landmark counts as reached when all that come before it were.
        """
        found = before
        for fact in _single(self.all & state & ~before):
            if not self._before[fact] & ~before:
                found |= fact
        return found

    def reaches(self, reached: int, adds: int) -> bool:
        """Whether one of the facts ``adds`` is a landmark that can be next: all that come before it were reached."""
        return any(not self._before[fact] & ~reached for fact in _single(adds & self.all & ~reached))

    def __call__(self, reached: int, state: int) -> int:
        """How many landmarks are to be reached from ``state``, for the first time or once more."""
        left = self.all & ~reached
        lost = self._missed & reached & ~state
        again = lost & self._goal
        for fact in _single(lost & ~self._goal):
            if self._enables[fact] & left:
                again |= fact
        return left.bit_count() + again.bit_count()


def _single(mask: int) -> list[int]:
    """The set bits of ``mask``, each as a mask."""
    found = []
    while mask:
        low = mask & -mask
        mask ^= low
        found.append(low)
    return found


def _propagated(initial: int, ways: Sequence[Relaxed]) -> dict[int, int]:
    """The landmarks of every fact that can be reached without deletes, itself included."""
    needed = {fact: 1 << fact for fact in bits(initial)}
    using: dict[int, list[int]] = defaultdict(list)
    for w, (pre, _, _) in enumerate(ways):
        for fact in bits(pre):
            using[fact].append(w)
    reached = initial
    waiting = [w for w, (pre, _, _) in enumerate(ways) if not pre & ~initial]
    while waiting:
        following: set[int] = set()
        for w in waiting:
            pre, add, _ = ways[w]
            if pre & ~reached:
                continue
            through = pre
            for fact in bits(pre):
                through |= needed[fact]
            for fact in bits(add):
                old = needed.get(fact)
                new = (through if old is None else old & through) | 1 << fact
                if new != old:
                    needed[fact] = new
                    reached |= 1 << fact
                    following.update(using[fact])
        waiting = sorted(following)
    return needed
