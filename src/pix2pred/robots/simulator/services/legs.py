"""Commands to the legs: standing, sitting, walking to a place, walking with a velocity; and how they are getting on."""

from __future__ import annotations

import time
from typing import Any

from bosdyn.api import basic_command_pb2

from pix2pred.robots.simulator.body import SimulatedBody
from pix2pred.robots.simulator.frames import floor_from_message
from pix2pred.robots.simulator.motion import End
from pix2pred.robots.simulator.services.answering import seconds_of
from pix2pred.robots.simulator.settings import BODY_FROM_PLACE
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.simulator.walking import Walk
from pix2pred.structs.space.poses import FloorPose

_STATUS = basic_command_pb2.RobotCommandFeedbackStatus

LONGEST_DRIVE = 30.0
"""Seconds that a velocity is walked with at most, however far off the command's end is."""


class CommandRefusedError(Exception):
    """A command that is not carried out, with the name of its status."""

    def __init__(self, status: str, why: str = "") -> None:
        super().__init__(why)
        self.status = status


def begin_legs(spot: SimulatedSpot, command: Any, *, synchronised: bool) -> Walk | None:
    """Carry out a command to the legs; gives the walk it began. Raises ``CommandRefusedError``."""
    body, kind = spot.body, command.WhichOneof("command")
    if kind == "stand_request":
        body.standing = True
    elif kind == "sit_request":
        body.halt()
        body.standing = False
    elif kind == "stop_request":
        body.halt()
    elif kind == "se2_trajectory_request":
        return _walk(spot, command.se2_trajectory_request, synchronised=synchronised)
    elif kind == "se2_velocity_request":
        return _drive(spot, command.se2_velocity_request, synchronised=synchronised)
    else:
        raise CommandRefusedError("STATUS_UNSUPPORTED", f"{kind} is not simulated")
    return None


def seconds_left(spot: SimulatedSpot, wanted: Any, *, synchronised: bool) -> float:
    """Seconds until a command's end. Raises ``CommandRefusedError`` when it is over, or means nothing yet."""
    if not synchronised:
        raise CommandRefusedError("STATUS_NO_TIMESYNC", "synchronise clocks first")
    left = seconds_of(wanted.end_time) - spot.time()
    if left <= 0:
        raise CommandRefusedError("STATUS_EXPIRED", "the command's end was over before it came")
    return left


def _walk(spot: SimulatedSpot, wanted: Any, *, synchronised: bool) -> Walk:
    left = seconds_left(spot, wanted, synchronised=synchronised)
    if wanted.se2_frame_name not in ("odom", "vision"):
        raise CommandRefusedError("STATUS_UNKNOWN_FRAME", f"walk in odom or vision, not in {wanted.se2_frame_name!r}")
    if not wanted.trajectory.points:
        raise CommandRefusedError("STATUS_INVALID_REQUEST", "a trajectory has points")
    _free_to_walk(spot.body)
    goal = floor_from_message(wanted.trajectory.points[-1].pose)
    return spot.body.go(goal * BODY_FROM_PLACE.inverse.floor, until=time.monotonic() + left)


def _drive(spot: SimulatedSpot, wanted: Any, *, synchronised: bool) -> Walk:
    left = seconds_left(spot, wanted, synchronised=synchronised)
    velocity = FloorPose(wanted.velocity.linear.x, wanted.velocity.linear.y, wanted.velocity.angular)
    if wanted.se2_frame_name in ("odom", "vision"):
        there = FloorPose(yaw=-spot.body.felt.yaw) * FloorPose(velocity.x, velocity.y)
        velocity = FloorPose(there.x, there.y, velocity.yaw)
    elif wanted.se2_frame_name not in ("body", "flat_body"):
        raise CommandRefusedError(
            "STATUS_UNKNOWN_FRAME", f"no velocity in {wanted.se2_frame_name!r}: body, odom or vision"
        )
    _free_to_walk(spot.body)
    return spot.body.drive(velocity, min(left, LONGEST_DRIVE))


def _free_to_walk(body: SimulatedBody) -> None:
    if body.docked:
        raise CommandRefusedError("STATUS_DOCKED", "undock first")
    body.standing = True


def report_legs(body: SimulatedBody, walk: Walk | None, command: Any, told: Any) -> None:
    """Say how a command to the legs is getting on."""
    told.status = _STATUS.STATUS_PROCESSING
    if command.HasField("stand_request"):
        stand = told.stand_feedback
        stand.status = stand.STATUS_IS_STANDING if body.standing else stand.STATUS_IN_PROGRESS
        stand.standing_state = stand.STANDING_CONTROLLED
    elif command.HasField("sit_request"):
        told.sit_feedback.status = told.sit_feedback.STATUS_IS_SITTING
    elif walk is None:
        return
    elif command.HasField("se2_velocity_request"):
        told.se2_velocity_feedback.SetInParent()
        if walk.end is End.DONE:
            told.status = _STATUS.STATUS_COMMAND_TIMED_OUT
    else:
        _report_walk(body, walk, told)


def _report_walk(body: SimulatedBody, walk: Walk, told: Any) -> None:
    way, running = told.se2_trajectory_feedback, walk.end is End.RUNNING
    way.status = way.STATUS_GOING_TO_GOAL if running else way.STATUS_AT_GOAL
    way.body_movement_status = way.BODY_STATUS_MOVING if running else way.BODY_STATUS_SETTLED
    way.final_goal_status = way.FINAL_GOAL_STATUS_IN_PROGRESS if running else way.FINAL_GOAL_STATUS_ACHIEVABLE
    if walk.end is End.BLOCKED:
        way.status, way.final_goal_status = way.STATUS_STOPPED, way.FINAL_GOAL_STATUS_BLOCKED
    elif walk.end is End.STOPPED:
        way.status = way.STATUS_STOPPED
        expired = body.now() >= walk.until
        told.status = _STATUS.STATUS_COMMAND_TIMED_OUT if expired else _STATUS.STATUS_COMMAND_OVERRIDDEN
