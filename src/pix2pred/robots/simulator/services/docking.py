"""A dock behind where the robot starts: walking onto it, charging there, and leaving it."""

from __future__ import annotations

import time
from typing import Any

from bosdyn.api.docking import docking_pb2, docking_service_pb2_grpc

from pix2pred.robots.simulator.body import SimulatedBody
from pix2pred.robots.simulator.motion import End
from pix2pred.robots.simulator.services.access import TimeSync
from pix2pred.robots.simulator.services.answering import Service, answers, answers_in_turn, used
from pix2pred.robots.simulator.services.legs import CommandRefusedError, seconds_left
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.simulator.walking import Walk
from pix2pred.structs.space.poses import FloorPose

STATION = 520
"""The number of the dock, the first of those that the vendor prints on docks."""

DOCK = FloorPose(-1.45, 0.0, 0.0)
"""Where the nose is on the dock, seen from where the robot starts."""

PREPARED = FloorPose(-0.65, 0.0, 0.0)
"""Where it is before the dock."""

_FEEDBACK = docking_pb2.DockingCommandFeedbackResponse


class DockingService(Service, docking_service_pb2_grpc.DockingServiceServicer):
    """``docking``: one dock. The robot sees it, so that odometry does not lead beside it."""

    def __init__(self, spot: SimulatedSpot, clocks: TimeSync) -> None:
        super().__init__(spot)
        self._clocks = clocks
        self._walks: dict[int, tuple[Walk, int]] = {}

    @answers_in_turn(docking_pb2.DockingCommandResponse, moment=True)
    def DockingCommand(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Walk onto the dock, before it, or off it."""
        if not used(self.spot, request.lease, answer.lease_use_result):
            answer.status = answer.STATUS_ERROR_LEASE
        else:
            answer.status = self._begin(request, answer)

    @answers_in_turn(_FEEDBACK)
    def DockingCommandFeedback(self, request: Any, answer: Any) -> None:  # noqa: N802
        """How it is getting on."""
        answer.lease_use_result.status = answer.lease_use_result.STATUS_OK
        walk, after = self._walks.get(request.docking_command_id, (None, _FEEDBACK.STATUS_OLD_DOCKING_COMMAND))
        ended = {
            End.RUNNING: _FEEDBACK.STATUS_IN_PROGRESS,
            End.DONE: after,
            End.BLOCKED: _FEEDBACK.STATUS_ERROR_STUCK,
            End.STOPPED: _FEEDBACK.STATUS_ERROR_COMMAND_TIMED_OUT,
        }
        answer.status = ended[walk.end] if walk is not None else after

    @answers(docking_pb2.GetDockingConfigResponse)
    def GetDockingConfig(self, request: Any, answer: Any) -> None:  # noqa: N802
        """The one dock."""
        answer.dock_configs.add(id_start=STATION, id_end=STATION, type=docking_pb2.DOCK_TYPE_SPOT_DOCK)

    @answers_in_turn(docking_pb2.GetDockingStateResponse)
    def GetDockingState(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Whether the robot is on it."""
        state, docked = answer.dock_state, self.spot.body.docked
        state.status = state.DOCK_STATUS_DOCKED if docked else state.DOCK_STATUS_UNDOCKED
        if docked:
            state.dock_id, state.dock_type = STATION, docking_pb2.DOCK_TYPE_SPOT_DOCK
            state.power_status = state.LINK_STATUS_CONNECTED

    def _begin(self, request: Any, answer: Any) -> int:
        """The status of a command, and its walk under way."""
        body, how = self.spot.body, request.prep_pose_behavior
        leaving = how == docking_pb2.PREP_POSE_UNDOCK
        if request.docking_station_id not in ((0, STATION) if leaving else (STATION,)):
            return int(answer.STATUS_ERROR_DOCK_NOT_FOUND)
        if leaving and not body.docked:
            return int(answer.STATUS_ERROR_NOT_DOCKED)
        if body.around.holding is not None:
            return int(answer.STATUS_ERROR_GRIPPER_HOLDING_ITEM)
        if not body.powered or body.fallen:
            return int(answer.STATUS_ERROR_NOT_AVAILABLE)
        try:
            left = seconds_left(self.spot, request, synchronised=self._clocks.knows(request.clock_identifier))
        except CommandRefusedError:
            return int(answer.STATUS_ERROR_SYSTEM)
        before = leaving or how == docking_pb2.PREP_POSE_ONLY_POSE
        via = [PREPARED] if before else [DOCK] if how == docking_pb2.PREP_POSE_SKIP_POSE else [PREPARED, DOCK]
        body.docked, body.standing = False, True
        walk = body.go_in_room([body.around.start * place for place in via], time.monotonic() + left)
        if not before:
            walk.then = lambda: _docked(body)
        number = body.next_number()
        self._walks[number] = walk, _FEEDBACK.STATUS_AT_PREP_POSE if before else _FEEDBACK.STATUS_DOCKED
        answer.docking_command_id = number
        return int(answer.STATUS_OK)


def _docked(body: SimulatedBody) -> None:
    body.docked, body.standing = True, False
