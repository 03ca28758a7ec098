"""A simulated Spot from the surroundings it is to stand in."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from pix2pred.robots.simulator.faults import Fault
from pix2pred.robots.simulator.server import Login, SpotServer
from pix2pred.robots.simulator.settings import Traits
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.spot.credentials import PASSWORD, USER
from pix2pred.structs.space.surroundings import Surroundings

CERTIFICATE = "robot.pem"


def serve(
    make: Callable[[], Surroundings], folder: Path, seed: int, port: int, pace: float, faults: Sequence[str]
) -> SpotServer:
    """Serve one on the loopback address; its certificate is written into ``folder``.

    Its user and password are those of the environment, if it names them. Raises ``FaultError`` and ``PortError``.
    """
    read = [Fault.read(text) for text in faults]
    folder.mkdir(parents=True, exist_ok=True)
    usual = Login()
    login = Login(os.environ.get(USER) or usual.user, os.environ.get(PASSWORD) or usual.password)
    spot = SimulatedSpot(make, Traits(pace=pace), read, seed)
    try:
        return SpotServer(spot, folder / CERTIFICATE, login, port)
    except BaseException:
        spot.close()
        raise
