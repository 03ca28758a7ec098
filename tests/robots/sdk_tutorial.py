"""Another program for the vendor's client, as its tutorials are written: poses, velocities, comments, a dock."""

from __future__ import annotations

import time
from typing import Any

import bosdyn.client
from bosdyn.client import math_helpers
from bosdyn.client.docking import DockingClient, blocking_dock_robot, blocking_undock, get_dock_id
from bosdyn.client.estop import EstopClient, EstopEndpoint, EstopKeepAlive
from bosdyn.client.frame_helpers import BODY_FRAME_NAME, ODOM_FRAME_NAME, get_se2_a_tform_b
from bosdyn.client.lease import LeaseClient, LeaseKeepAlive
from bosdyn.client.robot_command import (
    RobotCommandBuilder,
    RobotCommandClient,
    RobotCommandResponseError,
    blocking_stand,
)
from bosdyn.client.robot_state import RobotStateClient
from bosdyn.geometry import EulerZXY

DOCK = 520


def walk_and_dock(host: str, port: int, certificate: str, user: str, password: str) -> dict[str, Any]:
    """Stands in two poses, walks backwards, turns, docks, undocks, and powers off."""
    sdk = bosdyn.client.create_standard_sdk("tutorial", cert_resource_glob=certificate)
    robot = sdk.create_robot(host)
    robot.update_secure_channel_port(port)
    robot.authenticate(user, password)
    robot.time_sync.wait_for_sync(timeout_sec=60)
    endpoint = EstopEndpoint(robot.ensure_client(EstopClient.default_service_name), "tutorial", 60.0)
    endpoint.force_simple_setup()
    stop = EstopKeepAlive(endpoint)
    told: dict[str, Any] = {}
    leases = robot.ensure_client(LeaseClient.default_service_name)
    with LeaseKeepAlive(leases, must_acquire=True, return_at_exit=True):
        robot.power_on(timeout_sec=60, update_frequency=20)
        command = robot.ensure_client(RobotCommandClient.default_service_name)
        blocking_stand(command, timeout_sec=60, update_frequency=20)
        pose = EulerZXY(yaw=0.4, roll=0.0, pitch=0.0)
        command.robot_command(RobotCommandBuilder.synchro_stand_command(footprint_R_body=pose))
        command.robot_command(RobotCommandBuilder.synchro_stand_command(body_height=0.1))
        robot.operator_comment("a tutorial's comment")
        start = _body(robot)
        _drive(robot, -0.5, 0.0)
        told["ahead"] = (start.inverse() * _body(robot)).x
        _drive(robot, 0.0, 0.66)
        told["turned"] = (start.inverse() * _body(robot)).angle
        blocking_dock_robot(robot, DOCK, timeout=60)
        docking = robot.ensure_client(DockingClient.default_service_name)
        told["docked"] = get_dock_id(robot) == DOCK
        told["configured"] = [c.id_start for c in docking.get_docking_config()]
        power = robot.ensure_client(RobotStateClient.default_service_name).get_robot_state().power_state
        told["charging"] = power.shore_power_state == power.STATE_ON_SHORE_POWER
        try:
            _drive(robot, 0.5, 0.0)
        except RobotCommandResponseError as error:
            told["refused on the dock"] = type(error).__name__
        robot.power_on(timeout_sec=60, update_frequency=20)
        blocking_undock(robot, timeout=60)
        told["undocked"] = get_dock_id(robot) is None
        robot.power_off(cut_immediately=False, timeout_sec=60, update_frequency=20)
        told["powered"] = robot.is_powered_on()
    stop.shutdown()
    told["leases left"] = [r.lease_owner.client_name for r in leases.list_leases()]
    return told


def _drive(robot: Any, ahead: float, turning: float) -> None:
    """Walk with a velocity for a second."""
    command = robot.ensure_client(RobotCommandClient.default_service_name)
    velocity = RobotCommandBuilder.synchro_velocity_command(v_x=ahead, v_y=0.0, v_rot=turning)
    command.robot_command(velocity, end_time_secs=time.time() + 1.0)
    state = robot.ensure_client(RobotStateClient.default_service_name)
    while (now := state.get_robot_state().behavior_state).state == now.STATE_STEPPING:
        time.sleep(0.02)


def _body(robot: Any) -> math_helpers.SE2Pose:
    tree = robot.ensure_client(RobotStateClient.default_service_name).get_robot_state().kinematic_state
    return get_se2_a_tform_b(tree.transforms_snapshot, ODOM_FRAME_NAME, BODY_FRAME_NAME)
