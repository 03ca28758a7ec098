"""A program as people write it with the vendor's client alone: it knows nothing of this project or of simulation."""

from __future__ import annotations

import time
from typing import Any

import bosdyn.client
import numpy as np
from bosdyn.api import geometry_pb2, manipulation_api_pb2, robot_state_pb2
from bosdyn.api.basic_command_pb2 import SE2TrajectoryCommand
from bosdyn.client.estop import EstopClient, EstopEndpoint, EstopKeepAlive
from bosdyn.client.frame_helpers import BODY_FRAME_NAME, ODOM_FRAME_NAME, get_a_tform_b, get_se2_a_tform_b
from bosdyn.client.image import ImageClient, build_image_request
from bosdyn.client.lease import LeaseClient, LeaseKeepAlive
from bosdyn.client.manipulation_api_client import ManipulationApiClient
from bosdyn.client.math_helpers import SE2Pose
from bosdyn.client.power import power_off_motors, power_on_motors
from bosdyn.client.robot_command import (
    RobotCommandBuilder,
    RobotCommandClient,
    block_for_trajectory_cmd,
    block_until_arm_arrives,
    blocking_sit,
    blocking_stand,
)
from bosdyn.client.robot_state import RobotStateClient


def fetch_a_thing(host: str, port: int, certificate: str, user: str, password: str, see: Any) -> dict[str, Any]:
    """Logs in, stands up, walks half a metre, grasps what ``see`` finds in the hand camera's picture, and stows."""
    sdk = bosdyn.client.create_standard_sdk("someone-elses-program", cert_resource_glob=certificate)
    robot = sdk.create_robot(host)
    robot.update_secure_channel_port(port)
    robot.authenticate(user, password)
    robot.time_sync.wait_for_sync(timeout_sec=10)
    told: dict[str, Any] = {"serial": robot.get_id().serial_number, "has_arm": robot.has_arm()}
    told["skew"] = robot.time_sync.get_robot_clock_skew().seconds
    estop = robot.ensure_client(EstopClient.default_service_name)
    endpoint = EstopEndpoint(estop, "someone", 9.0)
    endpoint.force_simple_setup()
    stop = EstopKeepAlive(endpoint)
    lease_client = robot.ensure_client(LeaseClient.default_service_name)
    with LeaseKeepAlive(lease_client, must_acquire=True, return_at_exit=True):
        power_on_motors(robot.ensure_client("power"), timeout_sec=20, update_frequency=20)
        command = robot.ensure_client(RobotCommandClient.default_service_name)
        state = robot.ensure_client(RobotStateClient.default_service_name)
        blocking_stand(command, timeout_sec=10, update_frequency=20)
        told["powered"] = robot.is_powered_on()
        tree = state.get_robot_state().kinematic_state.transforms_snapshot
        here = get_se2_a_tform_b(tree, ODOM_FRAME_NAME, BODY_FRAME_NAME)
        goal = here * SE2Pose(-0.5, 0.0, 0.0)
        walk = RobotCommandBuilder.synchro_se2_trajectory_command(goal.to_proto(), ODOM_FRAME_NAME)
        number = command.robot_command(walk, end_time_secs=time.time() + 10)
        at_goal = (SE2TrajectoryCommand.Feedback.STATUS_AT_GOAL,)
        told["walked"] = block_for_trajectory_cmd(command, number, at_goal, feedback_interval_secs=0.02, timeout_sec=10)
        there = get_se2_a_tform_b(
            state.get_robot_state().kinematic_state.transforms_snapshot, ODOM_FRAME_NAME, BODY_FRAME_NAME
        )
        told["off by"] = float(np.hypot(there.x - goal.x, there.y - goal.y))
        number = command.robot_command(RobotCommandBuilder.arm_ready_command())
        told["ready"] = block_until_arm_arrives(command, number, 10)
        look = RobotCommandBuilder.arm_pose_command(0.83, 0, 0.94, 0.8788, 0, 0.4772, 0, BODY_FRAME_NAME, 0.1)
        told["looks"] = block_until_arm_arrives(command, command.robot_command(look), 10)
        images = robot.ensure_client(ImageClient.default_service_name)
        told["cameras"] = [s.name for s in images.list_image_sources()]
        picture = images.get_image([build_image_request("hand_color_image", quality_percent=90)])[0]
        told["grasped"] = _grasp(robot, picture, see(picture))
        hand = state.get_robot_state().manipulator_state
        told["holds"] = hand.is_gripper_holding_item
        manipulation = robot.ensure_client(ManipulationApiClient.default_service_name)
        carried = manipulation_api_pb2.ApiGraspedCarryStateOverride(
            override_request=robot_state_pb2.ManipulatorState.CARRY_STATE_CARRIABLE_AND_STOWABLE
        )
        manipulation.grasp_override_command(manipulation_api_pb2.ApiGraspOverrideRequest(carry_state_override=carried))
        number = command.robot_command(RobotCommandBuilder.arm_stow_command())
        told["stowed"] = block_until_arm_arrives(command, number, 10)
        frame = get_a_tform_b(state.get_robot_state().kinematic_state.transforms_snapshot, BODY_FRAME_NAME, "hand")
        told["hand ahead"] = frame.x
        blocking_sit(command, timeout_sec=10, update_frequency=20)
        power_off_motors(robot.ensure_client("power"), timeout_sec=20, update_frequency=20)
    stop.shutdown()
    told["leases left"] = [r.lease_owner.client_name for r in lease_client.list_leases()]
    return told


def _grasp(robot: Any, picture: Any, pixel: tuple[float, float]) -> str:
    client = robot.ensure_client(ManipulationApiClient.default_service_name)
    pick = manipulation_api_pb2.PickObjectInImage(
        pixel_xy=geometry_pb2.Vec2(x=pixel[0], y=pixel[1]),
        transforms_snapshot_for_camera=picture.shot.transforms_snapshot,
        frame_name_image_sensor=picture.shot.frame_name_image_sensor,
        camera_model=picture.source.pinhole,
    )
    request = manipulation_api_pb2.ManipulationApiRequest(pick_object_in_image=pick)
    number = client.manipulation_api_command(manipulation_api_request=request).manipulation_cmd_id
    final = {manipulation_api_pb2.MANIP_STATE_GRASP_SUCCEEDED, manipulation_api_pb2.MANIP_STATE_GRASP_FAILED}
    for _ in range(500):
        asked = manipulation_api_pb2.ManipulationApiFeedbackRequest(manipulation_cmd_id=number)
        state = client.manipulation_api_feedback_command(manipulation_api_feedback_request=asked).current_state
        if state in final:
            break
        time.sleep(0.02)
    return str(manipulation_api_pb2.ManipulationFeedbackState.Name(state))
