"""Motions that take time: walking, which drifts, and the hand going through a path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np

from pix2pred.robots.simulator.settings import Traits
from pix2pred.structs.space.poses import FloorPose, Pose, wrapped

Rng = np.random.Generator

TURN_PER_METRE = 0.4
"""Radians that the heading is off after a metre, as a multiple of the drift's share."""


class End(Enum):
    """How a motion ended, if it did."""

    RUNNING = auto()
    DONE = auto()
    BLOCKED = auto()
    STOPPED = auto()


def between(a: FloorPose, b: FloorPose, share: float) -> FloorPose:
    """The pose after ``share`` of the way, turning the shorter way."""
    turn = wrapped(b.yaw - a.yaw)
    return FloorPose(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), wrapped(a.yaw + share * turn))


@dataclass(slots=True)
class Walk:
    """Walking from one place to another, as odometry has it and as it is in truth."""

    number: int
    felt: tuple[FloorPose, FloorPose]
    true: tuple[FloorPose, FloorPose]
    began: float
    lasts: float
    until: float
    blocked: bool = False
    end: End = End.RUNNING

    def at(self, now: float) -> tuple[FloorPose, FloorPose]:
        """Where odometry has it and where it is now."""
        share = min(1.0, max(0.0, (now - self.began) / self.lasts)) if not self.blocked else 0.0
        return between(*self.felt, share), between(*self.true, share)


def walk(
    number: int, felt: FloorPose, true: FloorPose, goal: FloorPose, now: float, until: float, drift: float,
    traits: Traits, rng: Rng,
) -> Walk:  # fmt: skip
    """A walk to ``goal`` in the odometry's frame.

    The robot ends where its odometry says that the goal is; in truth the way was longer or shorter, and the turn
    larger or smaller, by a share drawn up to ``drift`` once a walk, and the heading is off by the way walked.
    """
    step = felt.inverse * goal
    way, turn = math.hypot(step.x, step.y), wrapped(step.yaw)
    longer, turned, off = rng.uniform(-drift, drift, size=3)
    heading = float(off) * TURN_PER_METRE * way
    c, s = math.cos(heading / 2), math.sin(heading / 2)
    stretch = 1 + float(longer)
    real = FloorPose(
        stretch * (c * step.x - s * step.y), stretch * (s * step.x + c * step.y), turn * (1 + float(turned)) + heading
    )
    lasts = max(0.2, way / traits.walking_speed + abs(turn) / traits.turning_speed)
    return Walk(number, (felt, goal), (true, true * real), now, lasts, until)


@dataclass(slots=True)
class Reach:
    """The hand going through ``path``, whose poses are seen from the place under the nose, each after a time."""

    number: int
    path: Sequence[Pose]
    after: Sequence[float]
    began: float
    reached: int = 0
    end: End = End.RUNNING
    named: int = 0
    """The named position of the protocol that the path leads to, 0 for none."""

    def due(self, now: float) -> int:
        """How many poses the hand should have reached by now."""
        return sum(now - self.began >= t for t in self.after)


def reach(
    number: int, hand: Pose, path: Sequence[Pose], times: Sequence[float], now: float, traits: Traits, named: int = 0
) -> Reach:
    """A way of the hand that takes the ``times`` asked for, or longer where that would be too fast."""
    after, last, where = [], 0.0, hand
    for pose, wanted in zip(path, times, strict=True):
        needs = float(np.linalg.norm(pose.at - where.at)) / traits.hand_speed + where.angle_to(pose) / 3.0
        last = max(last + needs, wanted)
        after.append(last)
        where = pose
    return Reach(number, path, after, now, named=named)
