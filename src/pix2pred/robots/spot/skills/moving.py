"""What skills share: taking a thing, standing where the hand reaches, holding a thing over a place and letting go."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pix2pred.robots.spot.finding import Found
from pix2pred.robots.spot.limbs import FailedError
from pix2pred.robots.spot.robot import Spot
from pix2pred.robots.standing import STAND_OFF, around
from pix2pred.structs.space.poses import Array, Pose

PLACES = 8
"""Places tried before a thing counts as out of reach."""

OVER = np.array([0.0, 0.0, 0.22])
"""From a place to where things are lowered onto it from, in metres."""


def hand_is_empty(spot: Spot) -> None:
    """Raise ``FailedError`` when the hand holds something."""
    if spot.holding is not None:
        raise FailedError(f"the hand already holds {spot.holding}")


def holds(spot: Spot, name: str) -> None:
    """Raise ``FailedError`` when the hand does not hold the thing called ``name``."""
    if spot.holding != name:
        raise FailedError(f"{name} is not held" + (f", {spot.holding} is" if spot.holding else ""))


def take(spot: Spot, name: str) -> None:
    """Take a thing that is seen from home. Raises ``FailedError``."""
    hand_is_empty(spot)
    seen = spot.find(name)[name][0]
    spot.limbs.grasp(seen.shot, *seen.inner_pixel())
    spot.took(name)


def stand_at(
    spot: Spot, middle: Sequence[float] | Array, points: Sequence[Array], distances: Sequence[float] = STAND_OFF
) -> None:
    """Walk to where the hand reaches all ``points`` around ``middle``; stays where it does already.

    Raises ``FailedError`` when no such place can be walked to.
    """
    here = spot.whereabouts.place(spot.limbs.odometry())
    if spot.reaches(here, points):
        return
    tried, why = 0, "no place from which the hand reaches it"
    for place in around(middle, here, distances):
        if not spot.reaches(place, points):
            continue
        try:
            spot.limbs.carry()
            spot.whereabouts.go(place)
            return
        except FailedError as error:
            why, tried = str(error), tried + 1
        if tried >= PLACES:
            break
    raise FailedError(f"cannot stand by it: {why}")


def down(at: Sequence[float] | Array, facing: float) -> Pose:
    """A hand that points at the floor."""
    return Pose.looking([float(v) for v in at], facing, math.pi / 2)


def facing(spot: Spot) -> float:
    """Where the robot's nose points in the map."""
    return spot.whereabouts.place(spot.limbs.odometry()).yaw


def let_go_at(spot: Spot, at: Array) -> None:
    """Walk to where the hand reaches ``at``, lower what is held to it, let go, and move the hand up."""
    stand_at(spot, at[:2], [at, at + OVER])
    yaw = facing(spot)
    spot.hand([down(at + OVER, yaw), down(at, yaw)])
    spot.limbs.open_fingers()
    spot.released()
    spot.hand([down(at + OVER, yaw)])
    spot.limbs.close_fingers()


def merged(seen: Sequence[Found]) -> Found:
    """The points of all cameras that see an object."""
    first = seen[0]
    return Found(first.name, first.shot, np.concatenate([f.points for f in seen]), first.pixels)
