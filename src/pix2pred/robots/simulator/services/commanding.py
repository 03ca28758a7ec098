"""Commands to legs, arm and fingers, and how they are getting on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from bosdyn.api import (
    arm_command_pb2,
    basic_command_pb2,
    robot_command_pb2,
    robot_command_service_pb2_grpc,
)

from pix2pred.robots.simulator.body import NAMED, SimulatedBody
from pix2pred.robots.simulator.frames import from_body, from_message
from pix2pred.robots.simulator.motion import End, Reach
from pix2pred.robots.simulator.services.access import TimeSync
from pix2pred.robots.simulator.services.answering import Service, answers_in_turn, seconds_of, used
from pix2pred.robots.simulator.services.legs import CommandRefusedError, begin_legs, report_legs
from pix2pred.robots.simulator.settings import BODY_FROM_PLACE
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.simulator.walking import Walk
from pix2pred.structs.space.poses import Pose

MOST_OPEN = 1.5708
"""Radians that the fingers open at most; the protocol counts them negative."""

REMEMBERED = 200
"""Commands of which it is known how they are getting on."""

_STATUS = basic_command_pb2.RobotCommandFeedbackStatus


@dataclass(slots=True)
class Doing:
    """What one command set going, part by part."""

    command: Any
    walk: Walk | None = None
    reach: Reach | None = None
    stalled: bool = False


class CommandService(Service, robot_command_service_pb2_grpc.RobotCommandServiceServicer):
    """``robot-command``: stand, sit, walk, stop; the hand's ways and named positions; the fingers."""

    def __init__(self, spot: SimulatedSpot, clocks: TimeSync) -> None:
        super().__init__(spot)
        self._clocks = clocks
        self._doing: dict[int, Doing] = {}

    @answers_in_turn(robot_command_pb2.RobotCommandResponse, moment=True)
    def RobotCommand(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Begin what is commanded."""
        if not used(self.spot, request.lease, answer.lease_use_result):
            return
        try:
            number = self._begin(request)
        except CommandRefusedError as error:
            answer.status, answer.message = answer.Status.Value(error.status), str(error)
        else:
            answer.status, answer.robot_command_id = answer.STATUS_OK, number

    @answers_in_turn(robot_command_pb2.RobotCommandFeedbackResponse)
    def RobotCommandFeedback(self, request: Any, answer: Any) -> None:  # noqa: N802
        """How a command is getting on."""
        self._report(request.robot_command_id, answer.feedback)

    @answers_in_turn(robot_command_pb2.ClearBehaviorFaultResponse)
    def ClearBehaviorFault(self, request: Any, answer: Any) -> None:  # noqa: N802
        """A fall is over."""
        if used(self.spot, request.lease, answer.lease_use_result):
            self.spot.body.fallen = False
            answer.status = answer.STATUS_CLEARED

    def _begin(self, request: Any) -> int:
        body, command = self.spot.body, request.command
        doing = Doing(command)
        if command.HasField("full_body_command"):
            self._whole_body(body, command.full_body_command)
        else:
            if not body.powered:
                raise CommandRefusedError("STATUS_NOT_POWERED_ON", "the motors are off")
            if body.fallen:
                raise CommandRefusedError("STATUS_BEHAVIOR_FAULT", "the robot has fallen")
            parts = command.synchronized_command
            if parts.HasField("mobility_command"):
                clock = self._clocks.knows(request.clock_identifier)
                doing.walk = begin_legs(self.spot, parts.mobility_command, synchronised=clock)
            if parts.HasField("arm_command"):
                self._arm(body, parts.arm_command, doing)
            if parts.HasField("gripper_command"):
                points = parts.gripper_command.claw_gripper_command.trajectory.points
                body.grip(min(1.0, max(0.0, -points[-1].point / MOST_OPEN)) if points else 0.0)
        number = body.next_number()
        self._doing[number] = doing
        while len(self._doing) > REMEMBERED:
            self._doing.pop(next(iter(self._doing)))
        return number

    @staticmethod
    def _whole_body(body: SimulatedBody, command: Any) -> None:
        kind = command.WhichOneof("command")
        if kind in ("stop_request", "freeze_request"):
            body.halt()
        elif kind == "safe_power_off_request":
            body.halt()
            body.standing = body.powered = False
        elif kind == "selfright_request":
            body.fallen = False
        else:
            raise CommandRefusedError("STATUS_UNSUPPORTED", f"{kind} is not simulated")

    def _arm(self, body: SimulatedBody, command: Any, doing: Doing) -> None:
        kind = command.WhichOneof("command")
        if kind == "named_arm_position_command":
            number = int(command.named_arm_position_command.position)
            if number not in NAMED:
                raise CommandRefusedError("STATUS_INVALID_REQUEST", "no such position of the arm")
            if NAMED[number] is NAMED[3] and body.around.holding is not None and not body.stowable:
                doing.stalled = True
            else:
                doing.reach = body.lead([NAMED[number]], [0.0])
        elif kind == "arm_cartesian_command":
            wanted = command.arm_cartesian_command
            root = self._root(body, wanted.root_frame_name) * from_message(wanted.root_tform_task)
            points = wanted.pose_trajectory_in_task.points
            path = [root * from_message(point.pose) for point in points]
            doing.reach = body.lead(path, [seconds_of(point.time_since_reference) for point in points])
        elif kind == "arm_gaze_command":
            doing.reach = body.lead([self._gaze(body, command.arm_gaze_command)], [0.0])
        elif kind == "arm_stop_command":
            body.lead([], [])
        else:
            raise CommandRefusedError("STATUS_UNSUPPORTED", f"{kind} is not simulated")

    @staticmethod
    def _root(body: SimulatedBody, name: str) -> Pose:
        """A frame seen from the place under the nose."""
        root = from_body(body, name)
        if root is None:
            raise CommandRefusedError("STATUS_UNKNOWN_FRAME", f"the robot knows no frame {name!r}")
        return BODY_FROM_PLACE * root

    def _gaze(self, body: SimulatedBody, wanted: Any) -> Pose:
        """The hand at the place asked for, or where it is, looking at the target."""
        point = wanted.target_trajectory_in_frame1.points[-1].point
        target = self._root(body, wanted.frame1_name) * from_message_point(point)
        hand = body.hand
        if wanted.tool_trajectory_in_frame2.points:
            root = self._root(body, wanted.frame2_name)
            hand = root * from_message(wanted.tool_trajectory_in_frame2.points[-1].pose)
        return looking_at(hand, target)

    def _report(self, number: int, feedback: Any) -> None:
        doing = self._doing.get(number) if number else next(reversed(self._doing.values()), None)
        if doing is None:
            return
        if doing.command.HasField("full_body_command"):
            self._report_whole(doing.command.full_body_command, feedback.full_body_feedback)
            return
        parts, told = doing.command.synchronized_command, feedback.synchronized_feedback
        if parts.HasField("mobility_command"):
            report_legs(self.spot.body, doing.walk, parts.mobility_command, told.mobility_command_feedback)
        if parts.HasField("arm_command"):
            self._report_arm(doing, parts.arm_command, told.arm_command_feedback)
        if parts.HasField("gripper_command"):
            told.gripper_command_feedback.status = _STATUS.STATUS_PROCESSING
            claw = told.gripper_command_feedback.claw_gripper_feedback
            claw.status = claw.STATUS_APPLYING_FORCE if self.spot.body.around.holding else claw.STATUS_AT_GOAL

    @staticmethod
    def _report_whole(command: Any, told: Any) -> None:
        told.status = _STATUS.STATUS_PROCESSING
        if command.HasField("safe_power_off_request"):
            told.safe_power_off_feedback.status = told.safe_power_off_feedback.STATUS_POWERED_OFF
        elif command.HasField("selfright_request"):
            told.selfright_feedback.status = told.selfright_feedback.STATUS_COMPLETED
        elif command.HasField("stop_request"):
            told.stop_feedback.SetInParent()
        else:
            told.freeze_feedback.SetInParent()

    @staticmethod
    def _report_arm(doing: Doing, command: Any, told: Any) -> None:
        told.status = _STATUS.STATUS_PROCESSING
        end = doing.reach.end if doing.reach is not None else End.DONE
        if end is End.STOPPED:
            told.status = _STATUS.STATUS_COMMAND_OVERRIDDEN
        if command.HasField("named_arm_position_command"):
            named = told.named_arm_position_feedback
            kinds = arm_command_pb2.NamedArmPositionsCommand.Feedback
            named.status = kinds.STATUS_COMPLETE if end is End.DONE else kinds.STATUS_IN_PROGRESS
            if doing.stalled or end is End.BLOCKED:
                named.status = kinds.STATUS_STALLED_HOLDING_ITEM
        elif command.HasField("arm_cartesian_command"):
            way = told.arm_cartesian_feedback
            way.status = {
                End.RUNNING: way.STATUS_IN_PROGRESS,
                End.DONE: way.STATUS_TRAJECTORY_COMPLETE,
                End.BLOCKED: way.STATUS_TRAJECTORY_STALLED,
                End.STOPPED: way.STATUS_TRAJECTORY_CANCELLED,
            }[end]
        elif command.HasField("arm_gaze_command"):
            gaze = told.arm_gaze_feedback
            done = end is End.DONE
            gaze.gazing_at_target = gaze.hand_position_at_goal = gaze.hand_roll_at_goal = done
            gaze.status = gaze.STATUS_TRAJECTORY_COMPLETE if done else gaze.STATUS_IN_PROGRESS
            if end is End.BLOCKED:
                gaze.status = gaze.STATUS_TOOL_TRAJECTORY_STALLED


def from_message_point(point: Any) -> Pose:
    """A point as a frame that is not turned."""
    return Pose(np.array([point.x, point.y, point.z]))


def looking_at(hand: Pose, target: Pose) -> Pose:
    """The hand where it is, its x axis towards the target and its y axis level."""
    dx, dy, dz = (float(v) for v in target.at - hand.at)
    return Pose.looking(hand.at.tolist(), math.atan2(dy, dx), -math.atan2(dz, math.hypot(dx, dy)))
