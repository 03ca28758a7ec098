"""What a simulated Spot is like: how fast it moves, how far it reaches, how patient it is. Seconds, metres, radians."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.structs.space.poses import FloorPose, Pose


@dataclass(frozen=True, slots=True)
class Traits:
    """``pace`` is how many seconds of motion pass in one second; time-outs of leases and stops are never hurried."""

    walking_speed: float = 0.6
    """The vendor's client asks for speeds up to 1.6; half a metre a second is usual near people."""

    turning_speed: float = 0.8

    hand_speed: float = 0.5

    pace: float = 1.0

    reach: float = 1.20
    """From the shoulder to the hand: the arm is 0.98 long, and the body leans by two hand's breadths."""

    lease_patience: float = 5.0
    """A lease that nobody retained for so long is stale: the robot stops, and others may acquire it. The vendor's
    client retains every two seconds."""

    clock_ahead: float = 2.5
    """How far the robot's clock is ahead of the machine's, so that programs that do not synchronise are found out."""

    samples: int = 3
    """Round trips that the time service wants to see before it calls a clock synchronised."""

    serial: str = "spot-SIM-0001"


BODY_FROM_PLACE = Pose.on_floor(FloorPose(-0.55, 0.0, 0.0), 0.58)
"""The frame ``body`` seen from the place on the floor under the nose."""

STOWED = Pose.looking((-0.12, 0.0, 0.80), 0.0, 0.0)
CARRYING = Pose.looking((0.05, 0.0, 0.95), 0.0, 0.0)
READY = Pose.looking((0.15, 0.0, 0.92), 0.0, 0.0)
"""Where the hand is in the arm's named positions, seen from the place under the nose."""

SHOULDER = (-0.22, 0.0, 0.80)

APPROACH = 0.10
"""Metres over a thing from which the hand comes down to grasp it."""
