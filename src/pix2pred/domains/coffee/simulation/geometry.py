"""Sizes and places of the coffee scene, in metres and radians; amounts in cups of middle size (method 10.3)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Point:
    """A place, or an offset."""

    x: float
    y: float
    z: float

    def __add__(self, other: Point) -> Point:
        return Point(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: Point) -> Point:
        return Point(self.x - other.x, self.y - other.y, self.z - other.z)

    def __iter__(self) -> Iterator[float]:
        return iter((self.x, self.y, self.z))

    def distance(self, other: Point) -> float:
        """Euclidean distance."""
        return math.dist(tuple(self), tuple(other))


def turned(offset: Point, tilt: float) -> Point:
    """``offset`` after the gripper tilted from pointing right towards pointing down."""
    c, s = math.cos(tilt), math.sin(tilt)
    return Point(offset.x * c + offset.z * s, offset.y, -offset.x * s + offset.z * c)


TABLE_Z = 0.2
"""Height of the table top."""

LOW, HIGH = Point(0.36, 1.05, 0.21), Point(1.1, 1.65, 0.75)
"""The box that the gripper can reach."""

HOME = Point(0.53, 1.48, 0.54)
"""Where the gripper rests and where it goes when it has let go of something."""

OPEN, CLOSED = 0.04, 0.012
"""Distance between the finger tips."""

JUG_RADIUS, JUG_HEIGHT = 0.052, 0.135
GRIP = Point(-0.088, 0.0, 0.085)
"""Where the jug is held, from the centre of its base, at ``rot`` 0."""

SPOUT = Point(0.064, 0.0, 0.135)
"""The tip of the spout, from the centre of the base, at ``rot`` 0."""

FULL_JUG = 6.75
"""What the machine fills in: enough for six cups of the largest size."""

CUP_CAPACITIES = (0.75, 0.875, 1.0, 1.125, 1.25)
CUP_RADIUS = {c: 0.034 * c ** (1 / 3) for c in CUP_CAPACITIES}
CUP_HEIGHT = {c: 0.066 * c ** (1 / 3) for c in CUP_CAPACITIES}

MACHINE_X, MACHINE_Y = 0.99, 1.52
PLATE = Point(MACHINE_X, MACHINE_Y - 0.09, TABLE_Z + 0.022)
"""The middle of the plate under the dispenser, where the jug stands."""

HEAD_BOTTOM, HEAD_TOP = TABLE_Z + 0.2, TABLE_Z + 0.34
BUTTON = Point(MACHINE_X - 0.098, MACHINE_Y - 0.08, TABLE_Z + 0.27)
"""The button on the left side of the machine's head."""

POUR_TILT = 0.85
"""Tilt at which coffee flows."""
