"""Motions that take time: how they end, and the hand going through a path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np

from pix2pred.robots.simulator.settings import Traits
from pix2pred.structs.space.poses import Pose


class End(Enum):
    """How a motion ended, if it did."""

    RUNNING = auto()
    DONE = auto()
    BLOCKED = auto()
    STOPPED = auto()


@dataclass(slots=True)
class Reach:
    """The hand going through ``path``, whose poses are seen from the place under the nose, each after a time."""

    path: Sequence[Pose]
    after: Sequence[float]
    began: float
    reached: int = 0
    end: End = End.RUNNING

    def due(self, now: float) -> int:
        """How many poses the hand should have reached by now."""
        return sum(now - self.began >= t for t in self.after)


def reach(hand: Pose, path: Sequence[Pose], times: Sequence[float], now: float, traits: Traits) -> Reach:
    """A way of the hand that takes the ``times`` asked for, or longer where that would be too fast."""
    after, last, where = [], 0.0, hand
    for pose, wanted in zip(path, times, strict=True):
        needs = float(np.linalg.norm(pose.at - where.at)) / traits.hand_speed + where.angle_to(pose) / 3.0
        last = max(last + needs, wanted)
        after.append(last)
        where = pose
    return Reach(path, after, now)
