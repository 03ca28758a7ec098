"""The simulated Spot as any program meets it: over gRPC and TLS, by the vendor's client, unmodified."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

from extras import need

pytestmark = [need("bosdyn.client", "pyapriltags", extra="spot"), need("mujoco", extra="sim")]


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Any]:
    from robots.simulated_spots import served

    with served(tmp_path) as made:
        yield made


def connect(server: Any, password: str | None = None) -> Any:
    import bosdyn.client

    from robots.simulated_spots import PASSWORD

    sdk = bosdyn.client.create_standard_sdk("test", cert_resource_glob=str(server.certificate))
    robot = sdk.create_robot("127.0.0.1")
    robot.update_secure_channel_port(server.port)
    robot.authenticate("user", PASSWORD if password is None else password)
    return robot


def red_pixel(picture: Any) -> tuple[float, float]:
    pixels = np.array(PIL.Image.open(io.BytesIO(picture.shot.image.data)).convert("RGB")).astype(int)
    red = (pixels[..., 0] > 150) & (pixels[..., 1] < 90) & (pixels[..., 2] < 90)
    red[:250] = False  # the scribbles on the table
    rows, columns = np.nonzero(red)
    return float(np.median(columns)), float(np.median(rows))


def test_a_program_of_somebody_else_runs_unchanged(server: Any) -> None:
    from robots.sdk_program import fetch_a_thing
    from robots.simulated_spots import PASSWORD

    told = fetch_a_thing("127.0.0.1", server.port, str(server.certificate), "user", PASSWORD, red_pixel)
    assert told["serial"] == "spot-SIM-0001" and told["has_arm"] and told["powered"]
    assert told["skew"] == 2, "the robot's clock is 2.5 seconds ahead, and time synchronisation says so"
    assert told["walked"] and told["off by"] < 0.01
    assert told["grasped"] == "MANIP_STATE_GRASP_SUCCEEDED" and told["holds"]
    assert told["stowed"] and told["leases left"] == [""]
    assert len([c for c in told["cameras"] if c.endswith("_image")]) == 6
    body = server.spot.body
    assert body.around.holding == "eraser", "what is really at the pixel: the red eraser on the floor"
    assert not body.powered and not body.standing


def test_a_tutorial_walks_with_velocities_and_goes_to_its_dock(server: Any) -> None:
    from robots.sdk_tutorial import walk_and_dock
    from robots.simulated_spots import PASSWORD

    told = walk_and_dock("127.0.0.1", server.port, str(server.certificate), "user", PASSWORD)
    assert -0.51 < told["ahead"] < -0.01, "half a metre a second, for a second less the time of the call"
    assert 0.01 < told["turned"] < 0.67
    assert told["docked"] and told["charging"] and told["refused on the dock"] == "DockedError"
    assert told["undocked"] and not told["powered"] and told["leases left"] == [""]


def test_a_wrong_password_and_a_missing_login_are_refused(server: Any) -> None:
    import bosdyn.client
    from bosdyn.client.exceptions import UnauthenticatedError

    with pytest.raises(bosdyn.client.auth.InvalidLoginError):
        connect(server, "wrong")
    sdk = bosdyn.client.create_standard_sdk("test", cert_resource_glob=str(server.certificate))
    robot = sdk.create_robot("127.0.0.1")
    robot.update_secure_channel_port(server.port)
    assert robot.get_id().species == "spot", "who it is, is told without a login"
    with pytest.raises(UnauthenticatedError):
        robot.ensure_client("robot-state").get_robot_state()


def test_services_that_are_not_there_are_not_registered(server: Any) -> None:
    from bosdyn.client.robot import UnregisteredServiceNameError

    robot = connect(server)
    names = {s.name for s in robot.list_services()}
    assert {"lease", "estop", "power", "image", "robot-command", "manipulation", "time-sync"} <= names
    with pytest.raises(UnregisteredServiceNameError):
        robot.ensure_client("spot-cam-ptz")


def test_time_synchronisation_wants_more_samples_first(server: Any) -> None:
    from bosdyn.api import time_sync_pb2

    client = connect(server).ensure_client("time-sync")
    answer = client.get_time_sync_update(None, None)
    assert answer.state.status == time_sync_pb2.TimeSyncState.STATUS_MORE_SAMPLES_NEEDED
    assert answer.header.error.code == 1 and answer.clock_identifier


def test_nothing_moves_without_lease_power_and_an_answered_stop(server: Any) -> None:
    from bosdyn.client.lease import LeaseKeepAlive, NoSuchLease
    from bosdyn.client.power import EstoppedError, power_on_motors
    from bosdyn.client.robot_command import NotPoweredOnError, RobotCommandBuilder

    robot = connect(server)
    robot.time_sync.wait_for_sync(timeout_sec=30)
    command = robot.ensure_client("robot-command")
    with pytest.raises(NoSuchLease):
        command.robot_command(RobotCommandBuilder.synchro_stand_command())
    with LeaseKeepAlive(robot.ensure_client("lease"), must_acquire=True, return_at_exit=True):
        with pytest.raises(NotPoweredOnError):
            command.robot_command(RobotCommandBuilder.synchro_stand_command())
        with pytest.raises(EstoppedError):
            power_on_motors(robot.ensure_client("power"), timeout_sec=5)
    assert not server.spot.body.powered and not server.spot.body.standing
    robot.stop_time_sync()


def test_two_programs_cannot_both_have_it_and_taking_it_stops_the_first(server: Any) -> None:
    from bosdyn.client.exceptions import LeaseUseError
    from bosdyn.client.lease import ResourceAlreadyClaimedError

    one, other = connect(server).ensure_client("lease"), connect(server).ensure_client("lease")
    lease = one.acquire()
    with pytest.raises(ResourceAlreadyClaimedError):
        other.acquire()
    other.take()
    with pytest.raises(LeaseUseError):
        one.retain_lease(lease)


def test_pictures_say_where_their_camera_is_and_distances_fit_them(server: Any) -> None:
    from bosdyn.client.image import UnknownImageSourceError, build_image_request

    client = connect(server).ensure_client("image")
    colour, depth = client.get_image_from_sources(["left_fisheye_image", "left_depth_in_visual_frame"])
    assert (colour.source.cols, colour.source.rows) == (depth.source.cols, depth.source.rows) == (640, 480)
    assert colour.source.pinhole.intrinsics.focal_length.x == pytest.approx(330.3, abs=0.1)
    far = np.frombuffer(depth.shot.image.data, dtype="<u2").reshape(480, 640) / depth.source.depth_scale
    assert 0.3 < float(np.median(far)) < 5
    assert colour.shot.frame_name_image_sensor in colour.shot.transforms_snapshot.child_to_parent_edge_map
    with pytest.raises(UnknownImageSourceError):
        client.get_image([build_image_request("periscope_image")])


def test_what_is_not_simulated_is_refused_by_its_name(server: Any) -> None:
    from bosdyn.client.lease import LeaseKeepAlive
    from bosdyn.client.robot_command import RobotCommandBuilder, UnsupportedError

    robot = connect(server)
    robot.time_sync.wait_for_sync(timeout_sec=30)
    server.spot.do(lambda: setattr(server.spot.body, "powered", True))
    with (
        LeaseKeepAlive(robot.ensure_client("lease"), must_acquire=True, return_at_exit=True),
        pytest.raises(UnsupportedError),
    ):
        robot.ensure_client("robot-command").robot_command(RobotCommandBuilder.battery_change_pose_command())
    robot.stop_time_sync()
