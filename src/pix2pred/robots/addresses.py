"""What ``--robot`` names: a simulated episode, or a Spot at a host."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.system.errors import Pix2predError

FORMS = "sim:DOMAIN/FAMILY/SEED[/INDEX], spot:HOST[:PORT]"


class AddressError(Pix2predError, ValueError):
    """A name of no robot; the message lists the forms."""


@dataclass(frozen=True, slots=True)
class SimulatedEpisode:
    """A simulated episode in place of a robot, with neither network nor walking.

    It is the test task numbered ``index`` of the domain's family, made from ``seed``.
    """

    domain: str
    family: str
    seed: int
    index: int = 0


@dataclass(frozen=True, slots=True)
class SpotAt:
    """A Spot at a host; ``port`` is that of a simulated one."""

    host: str
    port: int | None = None


def read_address(text: str) -> SimulatedEpisode | SpotAt:
    """The robot that ``text`` names. Raises ``AddressError``."""
    kind, colon, rest = text.partition(":")
    if kind == "sim" and colon:
        parts = rest.split("/")
        if len(parts) in (3, 4) and all(p.isdigit() for p in parts[2:]):
            return SimulatedEpisode(parts[0], parts[1], *map(int, parts[2:]))
    elif kind == "spot" and rest:
        host, _, port = rest.partition(":")
        if not port:
            return SpotAt(host)
        if port.isdigit() and 0 < int(port) < 2**16:
            return SpotAt(host, int(port))
    raise AddressError(f"no robot {text!r}; its forms are {FORMS}")
