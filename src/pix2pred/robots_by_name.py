"""Where names become robots: the registry's part for ``pix2pred robot``. Packages of robots are imported here alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pix2pred.execution import Solver
from pix2pred.registry import Registry, check_family
from pix2pred.robots.addresses import AddressError, SimulatedEpisode, SpotAt
from pix2pred.robots.robot import Robot, RobotMemory
from pix2pred.robots.simulated import SimulatedRobot
from pix2pred.structs import Task
from pix2pred.structs.environment import Domain
from pix2pred.structs.space.surroundings import Roamable
from pix2pred.system.extras import optional

if TYPE_CHECKING:
    from pix2pred.robots.simulator.server import SpotServer
    from pix2pred.robots.spot.surveying.check import CheckedPart
    from pix2pred.robots.spot.surveying.mapping import Enough, Mapped

_PROGRAMS = {
    "cleanup": "pix2pred.robots.spot.skills.cleanup:REPERTOIRE",
    "juice": "pix2pred.robots.spot.skills.juice:REPERTOIRE",
}
"""Programs for the skills of a domain, a ``Repertoire``; group ``pix2pred.programs``."""

_DETECTORS = {
    "bridge": "pix2pred.robots.spot.outliners:by_bridge",
    "vlm": "pix2pred.robots.spot.outliners:by_vlm",
    "transformers": "pix2pred.robots.spot.outliners:by_transformers",
}
"""From a session, what follows the colon and the model that labels, to what finds objects; ``pix2pred.detectors``."""


def simulated_robot(registry: Registry, address: SimulatedEpisode, task: Task) -> Robot:
    """A simulated episode as a robot, for a task about its scene. Raises ``UnknownNameError``."""
    made = registry.domain(address.domain)
    check_family(made, address.family)
    start = made.tasks(address.family, address.seed, address.index + 1)[address.index]
    return SimulatedRobot(made.environment(task, start.simulator), f"the simulation of {address.domain}")


def simulated_spot(
    domain: Domain, family: str, seed: int, index: int, folder: Path, port: int, pace: float, faults: Sequence[str]
) -> SpotServer:
    """A simulated Spot in a scene of ``domain``, which is served from now on. Raises ``AddressError``."""
    optional("bosdyn.client", "spot")
    from pix2pred.robots.simulator.making import serve

    if not isinstance(domain, Roamable):
        raise AddressError(f"no robot can walk in the worlds of {domain.name}; choose cleanup or juice")
    return serve(lambda: domain.roaming(family, seed, index), folder, seed, port, pace, faults)


def spot(
    registry: Registry, at: SpotAt, certificate: Path | None, task: Task, solver: Solver, detector: str,
    memory: RobotMemory,
) -> Robot:  # fmt: skip
    """A Spot with programs for the skills of ``solver``'s model. Raises ``UnknownNameError``."""
    optional("bosdyn.client", "spot")
    from pix2pred.robots.spot import making

    words = solver.model.vocabulary
    programs = registry.others("programs for skills", "programs", _PROGRAMS, words.name)
    kind, _, rest = detector.partition(":")
    outliner = registry.others("detector", "detectors", _DETECTORS, kind)
    session = making.connected(at, certificate)
    return making.spot(session, outliner(session, rest, solver.labeller.vlm), programs, task, words, memory)


def checked_spot(at: SpotAt, certificate: Path | None) -> Sequence[CheckedPart]:
    """What a person needs to know before the Spot at ``at`` moves."""
    optional("bosdyn.client", "spot")
    from pix2pred.robots.spot import making

    return making.checked(making.connected(at, certificate))


def mapped_tags(at: SpotAt, certificate: Path | None, size: float, enough: Enough, *, turn: bool) -> Mapped:
    """A map of the tags around the Spot at ``at``, from looks that are told to ``enough``. Raises ``RobotError``."""
    optional("bosdyn.client", "spot")
    from pix2pred.robots.spot import making

    return making.mapped(making.connected(at, certificate), size, enough, turn=turn)
