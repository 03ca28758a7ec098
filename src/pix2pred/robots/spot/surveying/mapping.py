"""A map of tags made from a walk: looks from many places while a person leads the robot, or while it turns about."""

from __future__ import annotations

import contextlib
import math
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pix2pred.robots.localising.tag_map import TagMap, TagMapError, map_from_walk
from pix2pred.robots.localising.tags import Sighting, TagFinder
from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.eyes import Eyes
from pix2pred.robots.spot.limbs import FailedError, Limbs
from pix2pred.robots.spot.session import SpotSession
from pix2pred.robots.spot.whereabouts import place_of, sightings
from pix2pred.structs.space.poses import FloorPose

FAR, TURNED = 0.4, math.radians(20)
"""Metres and radians that a robot has moved by before another look is worth its pictures."""

HEADINGS = 12
"""Looks of a robot that turns once about itself."""

Enough = Callable[[Sequence[int]], bool]
"""Is told the tags seen in a look; whether that was the last one."""


@dataclass(frozen=True, slots=True)
class Mapped:
    """A map; how many looks saw each tag; and how far off corners are in the worst look (pixels)."""

    tags: TagMap
    seen: Counter[int]
    looks: int
    worst: float


def led(session: SpotSession, size: float, enough: Enough) -> Mapped:
    """Looks, whenever a person has walked the robot on, until ``enough`` says so or Ctrl-C; nothing is moved or taken.

    The map's origin, which is home, is the place of the first look. Raises ``RobotError``.
    """
    looks = _Looks(session, size)
    with contextlib.suppress(KeyboardInterrupt):
        while not enough(looks.take()):
            while looks.near(Limbs(session).odometry().floor):
                time.sleep(session.settings.poll)
    return looks.mapped()


def turning(session: SpotSession, size: float, enough: Enough) -> Mapped:
    """The same while the robot, which stands, turns once about itself; headings that it cannot turn to are left out."""
    looks, limbs = _Looks(session, size), Limbs(session)
    start = limbs.odometry().floor
    over = enough(looks.take())
    for k in range(1, HEADINGS):
        if over:
            break
        with contextlib.suppress(FailedError):
            limbs.walk(start * FloorPose(yaw=2 * math.pi * k / HEADINGS))
            over = enough(looks.take())
    return looks.mapped()


class _Looks:
    """What was seen from where, by odometry from the first look on."""

    def __init__(self, session: SpotSession, size: float) -> None:
        self._session, self._finder, self._eyes = session, TagFinder(size), Eyes(session)
        self._first: FloorPose | None = None
        self._last = FloorPose()
        self._taken: list[tuple[FloorPose, Sequence[Sighting]]] = []

    def take(self) -> Sequence[int]:
        """Look around; the tags seen."""
        body, seen = sightings(self._eyes, self._finder, self._session.settings)
        self._last = body
        felt = place_of(body, self._session.settings)
        self._first = self._first or felt
        self._taken.append((self._first.inverse * felt, seen))
        return sorted({s.number for s in seen})

    def near(self, body: FloorPose) -> bool:
        """Whether the robot is still about where it looked last."""
        return body.distance(self._last) < FAR and body.turn_to(self._last) < TURNED

    def mapped(self) -> Mapped:
        """The map of all looks."""
        try:
            made = map_from_walk(self._finder.size, self._taken)
        except TagMapError as error:
            raise RobotError(Outcome.LOST, str(error)) from error
        fixes = [made.locate(seen, felt) for felt, seen in self._taken]
        counted = Counter(n for _, seen in self._taken for n in {s.number for s in seen})
        return Mapped(made, counted, len(self._taken), max(f.residual for f in fixes if f))
