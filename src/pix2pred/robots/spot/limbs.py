"""Legs, arm and fingers: commands with a deadline, watched until they end."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

from bosdyn.api import basic_command_pb2, geometry_pb2, manipulation_api_pb2
from bosdyn.client.robot_command import RobotCommandBuilder

from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.eyes import CameraShot
from pix2pred.robots.spot.frames import BODY, ODOM, floor_message, message, seen_from
from pix2pred.robots.spot.link import named
from pix2pred.robots.spot.session import SpotSession
from pix2pred.structs.space.poses import FloorPose, Pose

_STATUS = basic_command_pb2.RobotCommandFeedbackStatus


class FailedError(Exception):
    """A motion that did not get to its end, while the robot is fine: a skill has failed."""


class Limbs:
    """Moves the robot. Raises ``FailedError`` for motions that fail, ``RobotError`` when nothing more can move."""

    def __init__(self, session: SpotSession) -> None:
        self._session, self._settings = session, session.settings

    def odometry(self) -> Pose:
        """The body seen from odometry's frame."""
        return seen_from(self._session.state().kinematic_state.transforms_snapshot, ODOM, BODY)

    def walk(self, goal: FloorPose) -> None:
        """Walk until odometry says that the body is over ``goal``."""
        lasts = self._settings.deadlines.walk
        command = RobotCommandBuilder.synchro_se2_trajectory_command(floor_message(goal), ODOM)
        number = self._session.command(command, lasts)

        def arrived(feedback: Any) -> bool:
            legs = feedback.synchronized_feedback.mobility_command_feedback
            way = legs.se2_trajectory_feedback
            if way.final_goal_status == way.FINAL_GOAL_STATUS_BLOCKED:
                raise FailedError("the way is blocked")
            self._going_on(legs)
            settled = way.body_movement_status == way.BODY_STATUS_SETTLED
            return bool(way.status == way.STATUS_AT_GOAL and settled)

        self._wait(number, arrived, lasts, "walking")

    def carry(self) -> None:
        """Hold what was taken in front of the body."""
        number = self._session.command(RobotCommandBuilder.arm_carry_command())

        def arrived(feedback: Any) -> bool:
            arm = self._going_on(feedback.synchronized_feedback.arm_command_feedback)
            way = arm.named_arm_position_feedback
            if way.status == way.STATUS_STALLED_HOLDING_ITEM:
                raise FailedError("the arm cannot be folded with what it holds")
            return bool(way.status == way.STATUS_COMPLETE)

        self._wait(number, arrived, self._settings.deadlines.arm, "moving the arm")

    def hand(self, path: Sequence[Pose], frame: str, seconds: float = 0.0) -> None:
        """Move the hand through ``path``, seen from ``frame``, in no less than ``seconds``."""
        poses = [message(p) for p in path]
        times = [seconds * (i + 1) / len(path) for i in range(len(path))]
        command = RobotCommandBuilder.arm_cartesian_move_helper(poses, times, frame)
        number = self._session.command(command)

        def arrived(feedback: Any) -> bool:
            arm = self._going_on(feedback.synchronized_feedback.arm_command_feedback)
            way = arm.arm_cartesian_feedback
            if way.status in (way.STATUS_TRAJECTORY_STALLED, way.STATUS_TRAJECTORY_CANCELLED):
                raise FailedError("the hand did not get to where it was sent")
            return bool(way.status == way.STATUS_TRAJECTORY_COMPLETE)

        self._wait(number, arrived, self._settings.deadlines.arm, "moving the hand")

    def open_fingers(self) -> None:
        """Let go."""
        self._fingers(RobotCommandBuilder.claw_gripper_open_command())

    def close_fingers(self) -> None:
        """Close the fingers."""
        self._fingers(RobotCommandBuilder.claw_gripper_close_command())

    def grasp(self, shot: CameraShot, x: float, y: float) -> None:
        """Take what is seen at a pixel of the picture as taken; the robot walks there by itself."""
        pick = manipulation_api_pb2.PickObjectInImage(
            pixel_xy=geometry_pb2.Vec2(x=x, y=y),
            transforms_snapshot_for_camera=shot.response.shot.transforms_snapshot,
            frame_name_image_sensor=shot.response.shot.frame_name_image_sensor,
            camera_model=shot.response.source.pinhole,
            walk_gaze_mode=manipulation_api_pb2.PICK_AUTO_WALK_AND_GAZE,
        )
        answer = self._settings.deadlines.answer
        client = self._session.client("manipulation")
        with named("grasping", self._session.why):
            request = manipulation_api_pb2.ManipulationApiRequest(pick_object_in_image=pick)
            number = client.manipulation_api_command(request, timeout=answer).manipulation_cmd_id
        until = time.monotonic() + self._settings.deadlines.grasp
        kinds = manipulation_api_pb2
        while time.monotonic() < until:
            with named("asking how the grasp goes", self._session.why):
                asked = kinds.ManipulationApiFeedbackRequest(manipulation_cmd_id=number)
                state = client.manipulation_api_feedback_command(asked, timeout=answer).current_state
            if state == kinds.MANIP_STATE_GRASP_SUCCEEDED:
                return
            if state in (
                kinds.MANIP_STATE_GRASP_FAILED,
                kinds.MANIP_STATE_GRASP_PLANNING_NO_SOLUTION,
                kinds.MANIP_STATE_GRASP_FAILED_TO_RAYCAST_INTO_MAP,
            ):
                self._session.check()
                raise FailedError("the grasp failed")
            time.sleep(self._settings.poll)
        self._session.check()
        raise FailedError("the grasp did not end in time")

    def _fingers(self, command: Any) -> None:
        number = self._session.command(command)

        def arrived(feedback: Any) -> bool:
            claw = feedback.synchronized_feedback.gripper_command_feedback.claw_gripper_feedback
            return claw.status in (claw.STATUS_AT_GOAL, claw.STATUS_APPLYING_FORCE)

        self._wait(number, arrived, self._settings.deadlines.arm, "moving the fingers")

    def _wait(self, number: int, arrived: Any, lasts: float, doing: str) -> None:
        until = time.monotonic() + lasts
        looked = time.monotonic()
        while time.monotonic() < until:
            if arrived(self._session.feedback(number)):
                return
            if time.monotonic() - looked > CHECK_EVERY:
                self._session.check()
                looked = time.monotonic()
            time.sleep(self._settings.poll)
        self._session.check()
        raise FailedError(f"{doing} did not end within {lasts:g} s")

    def _going_on(self, part: Any) -> Any:
        """The feedback of legs or arm. Raises what is wrong with the robot, else that it was overridden."""
        if part.status == _STATUS.STATUS_PROCESSING:
            return part
        self._session.check()
        if not self._session.owns():
            raise RobotError(Outcome.LEASE_LOST, "somebody else commands the robot; give it back and try again")
        raise FailedError(f"it was not gone on with ({_STATUS.Status.Name(part.status)})")


CHECK_EVERY = 0.5
"""Seconds between two looks at the robot's own state while it moves."""
