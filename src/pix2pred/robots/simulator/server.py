"""A simulated Spot as a server on the loopback address: its services behind TLS, its certificate in a file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import grpc
from bosdyn.api import (
    auth_service_pb2_grpc,
    data_buffer_service_pb2_grpc,
    directory_service_pb2_grpc,
    estop_service_pb2_grpc,
    image_service_pb2_grpc,
    lease_service_pb2_grpc,
    manipulation_api_service_pb2_grpc,
    network_compute_bridge_service_pb2_grpc,
    power_service_pb2_grpc,
    robot_command_service_pb2_grpc,
    robot_id_service_pb2_grpc,
    robot_state_service_pb2_grpc,
    time_sync_service_pb2_grpc,
)
from bosdyn.api.docking import docking_service_pb2_grpc

from pix2pred.robots.simulator.certificate import make_certificate
from pix2pred.robots.simulator.services.access import Auth, Directory, Door, Doorkeeper, Entry, RobotId, TimeSync
from pix2pred.robots.simulator.services.commanding import CommandService
from pix2pred.robots.simulator.services.docking import DockingService
from pix2pred.robots.simulator.services.holding import EstopService, LeaseService, PowerService
from pix2pred.robots.simulator.services.noting import DataBufferService
from pix2pred.robots.simulator.services.seeing import ImageService, StateService
from pix2pred.robots.simulator.services.taking import DetectionService, ManipulationService
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.system.errors import Pix2predError

LOOPBACK = "127.0.0.1"
"""The only address listened on."""

WORKERS = 12
"""Calls answered at once; most wait for the robot's one thread."""

MOST_BYTES = 100 * 1024**2
"""Size of a message, as the client allows."""

_DOMAIN = "spot.robot"

_SERVICES = (
    Entry("auth", "bosdyn.api.AuthService", f"auth.{_DOMAIN}", token=False),
    Entry("robot-id", "bosdyn.api.RobotIdService", f"id.{_DOMAIN}", token=False),
    Entry("directory", "bosdyn.api.DirectoryService", f"api.{_DOMAIN}"),
    Entry("time-sync", "bosdyn.api.TimeSyncService", f"api.{_DOMAIN}"),
    Entry("lease", "bosdyn.api.LeaseService", f"api.{_DOMAIN}"),
    Entry("estop", "bosdyn.api.EstopService", f"estop.{_DOMAIN}"),
    Entry("power", "bosdyn.api.PowerService", f"power.{_DOMAIN}"),
    Entry("robot-state", "bosdyn.api.RobotStateService", f"state.{_DOMAIN}"),
    Entry("robot-command", "bosdyn.api.RobotCommandService", f"command.{_DOMAIN}"),
    Entry("image", "bosdyn.api.ImageService", f"api.{_DOMAIN}"),
    Entry("manipulation", "bosdyn.api.ManipulationApiService", f"manipulation.{_DOMAIN}"),
    Entry("docking", "bosdyn.api.docking.DockingService", f"docking.{_DOMAIN}"),
    Entry("data-buffer", "bosdyn.api.DataBufferService", f"buffer.{_DOMAIN}"),
    Entry("network-compute-bridge", "bosdyn.api.NetworkComputeBridge", f"api.{_DOMAIN}"),
)


class PortError(Pix2predError, OSError):
    """The port cannot be listened on."""


@dataclass(frozen=True, slots=True)
class Login:
    """The one user of a simulated robot."""

    user: str = "user"
    password: str = "simulated"


class SpotServer:
    """Serves ``spot`` from its making until ``close``; ``certificate`` is the file that clients need."""

    def __init__(self, spot: SimulatedSpot, certificate: Path, login: Login, port: int = 0) -> None:
        self.spot, self.certificate, self.login = spot, certificate, login
        names = sorted({e.authority for e in _SERVICES})
        made = make_certificate(names)
        certificate.write_bytes(made.chain)
        door = Door(login.user, login.password)
        options = [("grpc.max_send_message_length", MOST_BYTES), ("grpc.max_receive_message_length", MOST_BYTES),
                   ("grpc.so_reuseport", 0)]  # fmt: skip
        self._server = grpc.server(ThreadPoolExecutor(WORKERS), interceptors=(Doorkeeper(door),), options=options)
        for add, servicer in _servicers(spot, door):
            add(servicer, self._server)
        credentials = grpc.ssl_server_credentials([(made.key, made.chain)])
        try:
            self.port = int(self._server.add_secure_port(f"{LOOPBACK}:{port}", credentials))
        except RuntimeError as error:
            raise PortError(
                f"port {port} of {LOOPBACK} cannot be listened on ({error}); name another with --port"
            ) from error
        self._server.start()

    def wait(self) -> None:
        """Until somebody else ends the server."""
        self._server.wait_for_termination()

    def close(self) -> None:
        """Answer nothing more, and end the robot."""
        self._server.stop(0).wait()
        self.spot.close()


def _servicers(spot: SimulatedSpot, door: Door) -> Sequence[tuple[Callable[[Any, Any], None], Any]]:
    clocks = TimeSync(spot)
    return (
        (auth_service_pb2_grpc.add_AuthServiceServicer_to_server, Auth(spot, door)),
        (robot_id_service_pb2_grpc.add_RobotIdServiceServicer_to_server, RobotId(spot)),
        (directory_service_pb2_grpc.add_DirectoryServiceServicer_to_server, Directory(spot, _SERVICES)),
        (time_sync_service_pb2_grpc.add_TimeSyncServiceServicer_to_server, clocks),
        (lease_service_pb2_grpc.add_LeaseServiceServicer_to_server, LeaseService(spot)),
        (estop_service_pb2_grpc.add_EstopServiceServicer_to_server, EstopService(spot)),
        (power_service_pb2_grpc.add_PowerServiceServicer_to_server, PowerService(spot)),
        (robot_state_service_pb2_grpc.add_RobotStateServiceServicer_to_server, StateService(spot)),
        (robot_command_service_pb2_grpc.add_RobotCommandServiceServicer_to_server, CommandService(spot, clocks)),
        (image_service_pb2_grpc.add_ImageServiceServicer_to_server, ImageService(spot)),
        (docking_service_pb2_grpc.add_DockingServiceServicer_to_server, DockingService(spot, clocks)),
        (data_buffer_service_pb2_grpc.add_DataBufferServiceServicer_to_server, DataBufferService(spot)),
        (manipulation_api_service_pb2_grpc.add_ManipulationApiServiceServicer_to_server, ManipulationService(spot)),
        (
            network_compute_bridge_service_pb2_grpc.add_NetworkComputeBridgeServicer_to_server,
            DetectionService(spot),
        ),
    )
