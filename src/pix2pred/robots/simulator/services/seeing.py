"""What the robot sees and feels: pictures, distances, its own state."""

from __future__ import annotations

import io
import time
from typing import Any

import numpy as np
import PIL.Image
from bosdyn.api import image_pb2, image_service_pb2_grpc, robot_state_pb2, robot_state_service_pb2_grpc

from pix2pred.robots.simulator.frames import known, sensor, snapshot, with_sensor
from pix2pred.robots.simulator.services.answering import Service, answering, answers, answers_in_turn, stamp
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.simulator.stops import StopLevel
from pix2pred.structs.space.surroundings import CameraMount

DEPTH_SCALE = 1000.0
"""Units of a distance in a picture of distances in a metre."""

SILENCE = 30.0
"""Seconds that a silent camera takes to answer: longer than any client waits."""

_QUALITY = 95


def visual(camera: CameraMount) -> str:
    """The name of a camera's source of colours."""
    return f"{camera.name}_image"


def distances(camera: CameraMount) -> str:
    """The name of a camera's source of distances, pixel by pixel those of its colours."""
    if camera.in_hand:
        return f"{camera.name.partition('_')[0]}_depth_in_{camera.name}_frame"
    return f"{camera.name.partition('_')[0]}_depth_in_visual_frame"


class ImageService(Service, image_service_pb2_grpc.ImageServiceServicer):
    """``image``: six cameras as they are mounted, and distances for each."""

    def __init__(self, spot: SimulatedSpot) -> None:
        super().__init__(spot)
        cameras = spot.body.around.cameras
        self._sources = {visual(c): (c, False) for c in cameras} | {distances(c): (c, True) for c in cameras}

    @answers(image_pb2.ListImageSourcesResponse)
    def ListImageSources(self, request: Any, answer: Any) -> None:  # noqa: N802
        """All sources."""
        for name, (camera, is_depth) in self._sources.items():
            fill_source(answer.image_sources.add(), name, camera, is_depth)

    def GetImage(self, request: Any, context: Any) -> Any:  # noqa: N802
        """A picture of each source asked for, all taken at once."""
        answer = image_pb2.GetImageResponse()

        def take() -> None:
            for wanted in request.image_requests:
                response = answer.image_responses.add()
                if wanted.image_source_name not in self._sources:
                    response.status = response.STATUS_UNKNOWN_CAMERA
                    response.source.name = wanted.image_source_name
                    continue
                self.take(wanted, response)

        with answering(self.spot, request, answer):
            self.spot.do(take, moment=True)
            if self.spot.body.silent_cameras:
                until = time.monotonic() + SILENCE
                while time.monotonic() < until and context.is_active():
                    time.sleep(0.05)
        return answer

    def take(self, wanted: Any, response: Any) -> None:
        """Fill ``response`` with the picture that ``wanted`` asks for. In the robot's thread."""
        camera, is_depth = self._sources[wanted.image_source_name]
        body = self.spot.body
        fill_source(response.source, wanted.image_source_name, camera, is_depth)
        shot = response.shot
        shot.acquisition_time.CopyFrom(stamp(self.spot.time()))
        shot.frame_name_image_sensor = sensor(camera)
        shot.transforms_snapshot.CopyFrom(snapshot(with_sensor(body, camera)))
        shot.image.cols, shot.image.rows = camera.width, camera.height
        response.status = response.STATUS_OK
        if is_depth:
            far = np.clip(body.around.depth(camera.name) * DEPTH_SCALE, 0, 2**16 - 1)
            shot.image.pixel_format, shot.image.format = shot.image.PIXEL_FORMAT_DEPTH_U16, shot.image.FORMAT_RAW
            shot.image.data = far.astype("<u2").tobytes()
            return
        pixels = body.around.colour(camera.name)
        raw = wanted.image_format in (shot.image.FORMAT_RAW, shot.image.FORMAT_RLE)
        if wanted.pixel_format == shot.image.PIXEL_FORMAT_GREYSCALE_U8:
            picture = PIL.Image.fromarray(pixels).convert("L")
            shot.image.pixel_format = shot.image.PIXEL_FORMAT_GREYSCALE_U8
        elif wanted.pixel_format in (shot.image.PIXEL_FORMAT_UNKNOWN, shot.image.PIXEL_FORMAT_RGB_U8):
            picture = PIL.Image.fromarray(pixels)
            shot.image.pixel_format = shot.image.PIXEL_FORMAT_RGB_U8
        else:
            response.status = response.STATUS_UNSUPPORTED_PIXEL_FORMAT_REQUESTED
            return
        shot.image.format = shot.image.FORMAT_RAW if raw else shot.image.FORMAT_JPEG
        shot.image.data = picture.tobytes() if raw else _jpeg(picture, wanted.quality_percent)


def _jpeg(picture: PIL.Image.Image, quality: float) -> bytes:
    file = io.BytesIO()
    picture.save(file, "JPEG", quality=round(quality) or _QUALITY)
    return file.getvalue()


def fill_source(source: Any, name: str, camera: CameraMount, is_depth: bool) -> None:
    """What a camera is like."""
    source.name, source.cols, source.rows = name, camera.width, camera.height
    source.image_type = source.IMAGE_TYPE_DEPTH if is_depth else source.IMAGE_TYPE_VISUAL
    if is_depth:
        source.depth_scale = DEPTH_SCALE
        source.pixel_formats.append(image_pb2.Image.PIXEL_FORMAT_DEPTH_U16)
    else:
        source.pixel_formats.extend([image_pb2.Image.PIXEL_FORMAT_RGB_U8, image_pb2.Image.PIXEL_FORMAT_GREYSCALE_U8])
        source.image_formats.append(image_pb2.Image.FORMAT_JPEG)
    source.image_formats.append(image_pb2.Image.FORMAT_RAW)
    inner = source.pinhole.intrinsics
    inner.focal_length.x = inner.focal_length.y = camera.focal
    inner.principal_point.x, inner.principal_point.y = camera.width / 2, camera.height / 2


class StateService(Service, robot_state_service_pb2_grpc.RobotStateServiceServicer):
    """``robot-state``: power, battery, stops, faults, frames, hand."""

    @answers_in_turn(robot_state_pb2.RobotStateResponse)
    def GetRobotState(self, request: Any, answer: Any) -> None:  # noqa: N802
        """All of it now."""
        self._fill(answer.robot_state)

    @answers(robot_state_pb2.RobotMetricsResponse)
    def GetRobotMetrics(self, request: Any, answer: Any) -> None:  # noqa: N802
        """No metrics."""
        answer.robot_metrics.timestamp.CopyFrom(stamp(self.spot.time()))

    @answers(robot_state_pb2.RobotHardwareConfigurationResponse)
    def GetRobotHardwareConfiguration(self, request: Any, answer: Any) -> None:  # noqa: N802
        """A Spot with an arm."""
        for name in ("body", "arm0.link_sh0", "arm0.link_wr1"):
            answer.hardware_configuration.skeleton.links.add(name=name)

    def _fill(self, state: Any) -> None:
        body, now = self.spot.body, stamp(self.spot.time())
        power = state.power_state
        power.timestamp.CopyFrom(now)
        power.motor_power_state = power.STATE_ON if body.powered else power.STATE_OFF
        power.shore_power_state = power.STATE_ON_SHORE_POWER if body.docked else power.STATE_OFF_SHORE_POWER
        power.robot_power_state = power.ROBOT_POWER_STATE_ON
        power.locomotion_charge_percentage.value = body.charge
        battery = state.battery_states.add(
            identifier="simulated", status=robot_state_pb2.BatteryState.STATUS_DISCHARGING
        )
        battery.charge_percentage.value = body.charge
        kinds = robot_state_pb2.EStopState
        stopped = body.stops.level is not StopLevel.NONE
        for name, kind, pressed in (
            ("hardware_estop", kinds.TYPE_HARDWARE, body.stops.pressed),
            ("software_estop", kinds.TYPE_SOFTWARE, stopped),
        ):
            state.estop_states.add(
                name=name, type=kind, state=kinds.STATE_ESTOPPED if pressed else kinds.STATE_NOT_ESTOPPED
            )
        if body.fallen:
            fault = robot_state_pb2.BehaviorFault
            state.behavior_fault_state.faults.add(
                behavior_fault_id=1, cause=fault.CAUSE_FALL, status=fault.STATUS_UNCLEARABLE
            )
        state.behavior_state.state = (
            state.behavior_state.STATE_STEPPING
            if body.moving
            else state.behavior_state.STATE_STANDING
            if body.standing
            else state.behavior_state.STATE_NOT_READY
        )
        state.kinematic_state.acquisition_timestamp.CopyFrom(now)
        state.kinematic_state.transforms_snapshot.CopyFrom(snapshot(known(body)))
        hand = state.manipulator_state
        hand.gripper_open_percentage = 100 * body.open
        hand.is_gripper_holding_item = body.around.holding is not None
        hand.stow_state = hand.STOWSTATE_STOWED if body.stowed else hand.STOWSTATE_DEPLOYED
        hand.carry_state = hand.CARRY_STATE_CARRIABLE_AND_STOWABLE if body.stowable else hand.CARRY_STATE_CARRIABLE
