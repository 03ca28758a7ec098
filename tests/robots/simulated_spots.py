"""Simulated Spots for tests: fast in their motions, patient with a busy machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from pix2pred.domains.cleanup import CleanupDomain
from pix2pred.domains.home.domain import HomeDomain
from pix2pred.domains.juice import JuiceDomain
from pix2pred.robots.robot import RobotMemory
from pix2pred.robots.simulator.faults import Fault
from pix2pred.robots.simulator.server import Login, SpotServer
from pix2pred.robots.simulator.settings import Traits
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.spot.credentials import Credentials
from pix2pred.robots.spot.finding import ByBridge
from pix2pred.robots.spot.robot import Hand, Spot
from pix2pred.robots.spot.session import Address, SpotSession
from pix2pred.robots.spot.settings import Deadlines, SpotSettings
from pix2pred.robots.spot.skills import cleanup, juice
from pix2pred.structs import Task

PASSWORD = "planted-s3cret-7f1c"
DOMAINS: dict[str, HomeDomain] = {"cleanup": CleanupDomain(), "juice": JuiceDomain()}
REPERTOIRES = {"cleanup": cleanup.REPERTOIRE, "juice": juice.REPERTOIRE}
PATIENT = Deadlines(*[90.0] * 8)
"""Tests run on busy machines; what they wait for comes, or a fault ends it."""

FAST = Traits(pace=40.0, lease_patience=90.0)


@contextmanager
def served(
    folder: Path, domain: str = "cleanup", family: str = "new-objects", index: int = 0, *, seed: int = 0,
    faults: Sequence[str] = (), traits: Traits = FAST, robot_seed: int = 0,
) -> Iterator[SpotServer]:  # fmt: skip
    made = DOMAINS[domain]
    spot = SimulatedSpot(lambda: made.roaming(family, seed, index), traits, [Fault.read(f) for f in faults], robot_seed)
    server = SpotServer(spot, folder / "robot.pem", Login("user", PASSWORD))
    try:
        yield server
    finally:
        server.close()


def session_with(server: SpotServer, settings: SpotSettings | None = None, password: str = PASSWORD) -> SpotSession:
    address = Address("127.0.0.1", server.port, str(server.certificate))
    usual = SpotSettings(deadlines=PATIENT, poll=0.01, estop_timeout=90.0)
    return SpotSession(address, Credentials("user", password), settings or usual)


def spot_for(
    server: SpotServer, domain: str, task: Task, memory: RobotMemory = RobotMemory(),  # noqa: B008
    settings: SpotSettings | None = None,
) -> Spot:  # fmt: skip
    session = session_with(server, settings)
    words = DOMAINS[domain].vocabulary("new-objects")
    outlines = ByBridge(session, "simulated-segmentation")
    return Spot("spot", session, outlines, task.objects, Hand(REPERTOIRES[domain], words), memory)
