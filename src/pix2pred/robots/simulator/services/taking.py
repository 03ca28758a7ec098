"""Grasping what is seen at a pixel, and detecting objects in a camera's picture by a network beside the robot."""

from __future__ import annotations

from typing import Any

import numpy as np
from bosdyn.api import (
    manipulation_api_pb2,
    manipulation_api_service_pb2_grpc,
    network_compute_bridge_pb2,
    network_compute_bridge_service_pb2_grpc,
    robot_state_pb2,
)
from google.protobuf.wrappers_pb2 import FloatValue

from pix2pred.robots.simulator.frames import snapshot, with_sensor
from pix2pred.robots.simulator.services.answering import Service, answers, answers_in_turn, used
from pix2pred.robots.simulator.services.seeing import fill_source, visual
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.spot.frames import ODOM, seen_from

MODEL = "simulated-segmentation"
"""The one model of the network: it names what the simulator draws."""

OUTLINES = "objects"
"""The picture in its answer that holds, pixel by pixel, the identifier of the object seen there, 0 for none."""

_WALKS = (
    manipulation_api_pb2.PICK_WALK_GAZE_UNKNOWN,
    manipulation_api_pb2.PICK_AUTO_WALK_AND_GAZE,
)


class ManipulationService(Service, manipulation_api_service_pb2_grpc.ManipulationApiServiceServicer):
    """``manipulation``: take what is seen at a pixel."""

    @answers_in_turn(manipulation_api_pb2.ManipulationApiResponse, moment=True)
    def ManipulationApi(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Begin to take it."""
        body = self.spot.body
        if not used(self.spot, request.lease, answer.lease_use_result):
            return
        if not request.HasField("pick_object_in_image"):
            raise NotImplementedError("only pick_object_in_image is simulated")
        if not body.powered or not body.standing:
            raise RuntimeError("power on and stand before a grasp")
        pick = request.pick_object_in_image
        eye = seen_from(pick.transforms_snapshot_for_camera, ODOM, pick.frame_name_image_sensor)
        lens = pick.camera_model.intrinsics
        x = (pick.pixel_xy.x - lens.principal_point.x) / lens.focal_length.x
        y = (pick.pixel_xy.y - lens.principal_point.y) / lens.focal_length.y
        grasp = self.spot.grasping.begin(
            eye.at, eye.axes @ np.array([x, y, 1.0]), may_walk=pick.walk_gaze_mode in _WALKS
        )
        answer.manipulation_cmd_id = grasp.number

    @answers_in_turn(manipulation_api_pb2.ManipulationApiFeedbackResponse)
    def ManipulationApiFeedback(self, request: Any, answer: Any) -> None:  # noqa: N802
        """How a grasp is getting on."""
        grasp = self.spot.grasping.grasps.get(request.manipulation_cmd_id)
        answer.manipulation_cmd_id = request.manipulation_cmd_id
        answer.current_state = int(grasp.state) if grasp else manipulation_api_pb2.MANIP_STATE_UNKNOWN

    @answers_in_turn(manipulation_api_pb2.ApiGraspOverrideResponse)
    def OverrideGrasp(self, request: Any, answer: Any) -> None:  # noqa: N802
        """The client says that what is held may be carried and stowed."""
        wanted = request.carry_state_override.override_request
        self.spot.body.stowable = wanted == robot_state_pb2.ManipulatorState.CARRY_STATE_CARRIABLE_AND_STOWABLE


class DetectionService(Service, network_compute_bridge_service_pb2_grpc.NetworkComputeBridgeServicer):
    """``network-compute-bridge``: boxes and outlines of the objects that the simulator draws.

    It stands for a detector that somebody trained for these objects, as the vendor's bridge is made for.
    """

    def __init__(self, spot: SimulatedSpot) -> None:
        super().__init__(spot)
        self._cameras = {visual(c): c for c in spot.body.around.cameras}

    @answers(network_compute_bridge_pb2.ListAvailableModelsResponse)
    def ListAvailableModels(self, request: Any, answer: Any) -> None:  # noqa: N802
        """The one model, and the objects it knows."""
        answer.status = network_compute_bridge_pb2.LIST_AVAILABLE_MODELS_STATUS_SUCCESS
        answer.models.data.add(model_name=MODEL, available_labels=list(self.spot.body.around.names))

    @answers(network_compute_bridge_pb2.NetworkComputeResponse)
    def NetworkCompute(self, request: Any, answer: Any) -> None:  # noqa: N802
        """What the camera named sees now."""
        wanted = request.input_data.image_source_and_service
        name = wanted.image_source or wanted.image_request.image_source_name
        if request.input_data.model_name != MODEL or name not in self._cameras:
            answer.status = network_compute_bridge_pb2.NETWORK_COMPUTE_STATUS_EXTERNAL_SERVER_ERROR
            answer.alert_data.title = f"no model {request.input_data.model_name!r}, or no camera {name!r}"
            return
        self.spot.do(lambda: self._look(name, answer), moment=True)
        answer.status = network_compute_bridge_pb2.NETWORK_COMPUTE_STATUS_SUCCESS

    def _look(self, name: str, answer: Any) -> None:
        camera, body = self._cameras[name], self.spot.body
        owners = body.around.owners(camera.name)
        for number, label in enumerate(body.around.names, start=1):
            rows, columns = np.nonzero(owners == number)
            if not len(rows):
                continue
            found = answer.object_in_image.add(id=number, name=label)
            found.transforms_snapshot.CopyFrom(snapshot(with_sensor(body, camera)))
            score = FloatValue(value=1.0)
            found.additional_properties.Pack(score)
            corners = found.image_properties.coordinates
            left, right, top, bottom = columns.min(), columns.max() + 1, rows.min(), rows.max() + 1
            for x, y in ((left, top), (right, top), (right, bottom), (left, bottom)):
                corners.vertexes.add(x=float(x), y=float(y))
        outlines = answer.output_images[OUTLINES].image_response
        fill_source(outlines.source, name, camera, is_depth=False)
        image = outlines.shot.image
        image.cols, image.rows = camera.width, camera.height
        image.format, image.pixel_format = image.FORMAT_RAW, image.PIXEL_FORMAT_GREYSCALE_U8
        image.data = owners.astype(np.uint8).tobytes()
        outlines.status = outlines.STATUS_OK
