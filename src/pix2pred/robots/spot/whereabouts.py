"""Where the robot is in the map, by tags, and walking to places of the map: by odometry, corrected by tags."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pix2pred.robots.localising.tag_map import Fix, TagMap, TagMapError, map_from_walk
from pix2pred.robots.localising.tags import Sighting, TagFinder
from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.eyes import Eyes
from pix2pred.robots.spot.limbs import FailedError, Limbs
from pix2pred.robots.spot.settings import CAMERAS, HAND_CAMERA, SpotSettings
from pix2pred.structs.space.poses import FloorPose, Pose

_BODY_CAMERAS = tuple(c for c in CAMERAS if c != HAND_CAMERA)


def sightings(eyes: Eyes, finder: TagFinder, settings: SpotSettings) -> tuple[FloorPose, list[Sighting]]:
    """The tags that the body's cameras see, and where the body is by odometry. Raises ``RobotError``."""
    shots = eyes.shots(_BODY_CAMERAS, grey=True)
    body_from_floor = Pose(np.array([-settings.nose, 0.0, settings.body_height]))
    seen = []
    for name in sorted(shots):
        shot = shots[name]
        seen += finder.find(shot.pixels, body_from_floor * shot.camera, shot.lens)
    return next(iter(shots.values())).body.floor, seen


def place_of(body: FloorPose, settings: SpotSettings) -> FloorPose:
    """The place under the nose of a body."""
    return body * FloorPose(settings.nose)


class Whereabouts:
    """The map of tags and the place in it. Without a map, one is begun where the robot stands: that is its origin."""

    def __init__(self, eyes: Eyes, limbs: Limbs, settings: SpotSettings, file: Path | None) -> None:
        self._eyes, self._limbs, self._settings, self._file = eyes, limbs, settings, file
        self.tags = TagMap.load(file) if file is not None and file.exists() else None
        self._finder = TagFinder(self.tags.size if self.tags else settings.tag_size)
        self._map_from_odom: FloorPose | None = None

    @property
    def map_from_odom(self) -> FloorPose:
        """Odometry's frame seen from the map's, as the last look at tags has it. Raises ``RobotError``."""
        if self._map_from_odom is None:
            raise RobotError(
                Outcome.LOST, "no tag of the map is seen: bring the robot to where it sees some, or remove the map"
            )
        return self._map_from_odom

    def place(self, body: Pose) -> FloorPose:
        """The place under the nose in the map, for a body seen from odometry's frame."""
        return self.map_from_odom * place_of(body.floor, self._settings)

    def locate(self) -> Fix | None:
        """Look for tags. None when the map's are not seen or do not fit well enough: odometry then has to do."""
        body, seen = sightings(self._eyes, self._finder, self._settings)
        felt = place_of(body, self._settings)
        if self.tags is None:
            self._begin(seen)
        assert self.tags is not None, "a map was just begun"
        near = self._map_from_odom * felt if self._map_from_odom else None
        fix = self.tags.locate(seen, near)
        if fix is None or not fix.certain:
            return None
        self._map_from_odom = fix.place * felt.inverse
        self._learn(seen, fix.place)
        return fix

    def go(self, goal: FloorPose) -> None:
        """Walk until the nose is over ``goal``. Raises ``FailedError`` when that cannot be reached."""
        fix = self.locate()
        blind = 0.0
        for _ in range(self._settings.walks):
            here = fix.place if fix else self.place(self._limbs.odometry())
            if here.distance(goal) <= self._settings.near and here.turn_to(goal) <= self._settings.near_angle:
                return
            felt = self.map_from_odom.inverse * goal * FloorPose(-self._settings.nose)
            self._limbs.walk(felt)
            fix = self.locate()
            blind = 0.0 if fix else blind + here.distance(goal)
            if blind > self._settings.blind:
                raise RobotError(Outcome.LOST, f"no tag was seen on the last {blind:.1f} m: hang more of them")
        here = fix.place if fix else goal
        if here.distance(goal) > 5 * self._settings.near or here.turn_to(goal) > 5 * self._settings.near_angle:
            off, turn = here.distance(goal), math.degrees(here.turn_to(goal))
            raise FailedError(f"{off:.2f} m and {turn:.0f} degrees beside where it was sent")

    def _begin(self, seen: Sequence[Sighting]) -> None:
        try:
            self.tags = map_from_walk(self._finder.size, [(FloorPose(), seen)])
        except TagMapError as error:
            raise RobotError(Outcome.LOST, str(error)) from error
        self._save()

    def _learn(self, seen: Sequence[Sighting], place: FloorPose) -> None:
        """Put tags that are new into the map."""
        assert self.tags is not None, "there is a map to add to"
        known = dict(self.tags.tags)
        for s in seen:
            known.setdefault(s.number, Pose.on_floor(place) * s.camera * s.guess)
        if len(known) > len(self.tags.tags):
            self.tags = TagMap(self.tags.size, known)
            self._save()

    def _save(self) -> None:
        if self._file is not None and self.tags is not None:
            self.tags.save(self._file)
