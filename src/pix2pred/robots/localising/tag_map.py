"""A map of tags, and the place of a robot from all tags that it sees.

The place has three numbers: the robot stands upright on the floor. They are those that bring the corners of all tags
nearest to where they were seen (least squares of the distances in pixels, which count less where they are large).
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from pix2pred.robots.localising.tags import CORNERS, Sighting
from pix2pred.structs.space.poses import Array, FloorPose, Pose, axes_of, quaternion_of, turned_about
from pix2pred.system.errors import Pix2predError

ROBUST = 2.0
"""Pixels from which on a corner's distance counts less (Huber's loss)."""

DOUBTFUL = 2.5
"""Root mean square in pixels above which a place is not believed: tags at their places give 0.1 to 0.5."""

SURE = (0.05, math.radians(3))
"""Metres and radians of one standard deviation, beyond which a place is called uncertain."""


class TagMapError(Pix2predError, ValueError):
    """A map of tags that cannot be read or made; the message says why."""


@dataclass(frozen=True, slots=True)
class Fix:
    """A place, how far off the corners are (pixels, root mean square), and the standard deviations of the place."""

    place: FloorPose
    tags: int
    residual: float
    metres: float
    radians: float

    @property
    def certain(self) -> bool:
        """Whether it may be walked by."""
        return self.residual <= DOUBTFUL and self.metres <= SURE[0] and self.radians <= SURE[1]


@dataclass(frozen=True, slots=True)
class TagMap:
    """Where tags are in the map's frame. ``size`` is the side of their black square in metres."""

    size: float
    tags: Mapping[int, Pose]

    def locate(self, seen: Sequence[Sighting], near: FloorPose | None = None) -> Fix | None:
        """The place from all mapped tags seen; None without one. ``near`` is where odometry has the robot."""
        known = [s for s in seen if s.number in self.tags]
        if not known:
            return None
        starts = [_start(s, self.tags[s.number]) for s in known] + ([near] if near else [])
        return min((self._refined(known, start) for start in starts), key=lambda f: f.residual)

    def _refined(self, seen: Sequence[Sighting], start: FloorPose) -> Fix:
        def distances(place: Array) -> Array:
            base = Pose.on_floor(FloorPose(*map(float, place)))
            offsets = [_offsets(s, (base * s.camera).inverse * self.tags[s.number], self.size) for s in seen]
            return np.concatenate(offsets)

        best = least_squares(distances, (start.x, start.y, start.yaw), loss="huber", f_scale=ROBUST)
        residual = float(np.sqrt(np.mean(best.fun**2)))
        slopes = best.jac  # those of far corners are weighed down by the loss
        inverse = np.linalg.inv(slopes.T @ slopes + 1e-9 * np.eye(3)).diagonal()
        spread = max(residual, 0.1) ** 2 * np.maximum(inverse, 0)  # of a place far off, rounding may bring it below
        x, y, yaw = (float(v) for v in best.x)
        metres, radians = math.sqrt(spread[0] + spread[1]), math.sqrt(spread[2])
        return Fix(FloorPose(x, y, yaw), len(seen), residual, metres, radians)

    def save(self, file: Path) -> None:
        """Write the map."""
        tags = {str(n): [*map(float, p.at), *quaternion_of(p.axes)] for n, p in sorted(self.tags.items())}
        file.write_text(json.dumps({"version": 1, "size": self.size, "tags": tags}, indent=1) + "\n", encoding="utf-8")

    @classmethod
    def load(cls, file: Path) -> TagMap:
        """Read a map. Raises ``TagMapError``."""
        try:
            data = json.loads(file.read_text(encoding="utf-8"))
            tags = {
                int(n): Pose(np.array(v[:3], dtype=float), axes_of(*map(float, v[3:]))) for n, v in data["tags"].items()
            }
            return cls(float(data["size"]), tags)
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise TagMapError(f"{file}: is no map of tags ({error}); remove it, and one is made from here") from error


def map_from_walk(size: float, looks: Sequence[tuple[FloorPose, Sequence[Sighting]]], rounds: int = 6) -> TagMap:
    """A map in the frame of the first look, from looks on a walk, each with the place that odometry had.

    A tag is put where it was first seen from a look that is placed by tags mapped before, or by odometry; then places
    and tags are refined in turns. Raises ``TagMapError`` when no tag was seen.
    """
    tags: dict[int, Pose] = {}
    places: list[FloorPose] = []
    for felt, seen in looks:
        fix = TagMap(size, tags).locate(seen, felt)
        places.append(fix.place if fix and places else felt)
        for s in seen:
            tags.setdefault(s.number, Pose.on_floor(places[-1]) * s.camera * s.guess)
    if not tags:
        raise TagMapError("no tag was seen: hang AprilTags (family 36h11) where the robot's cameras see them")
    for _ in range(rounds):
        for number in sorted(tags):
            where = [(places[i], s) for i, (_, seen) in enumerate(looks) for s in seen if s.number == number]
            tags[number] = _tag_refined(where, tags[number], size)
        made = TagMap(size, tags)
        for i, (_, seen) in enumerate(looks):
            fix = made.locate(seen, places[i])
            if i and fix:
                places[i] = fix.place
    return TagMap(size, tags)


def _start(s: Sighting, tag: Pose) -> FloorPose:
    """Where the robot is by one tag alone."""
    return (tag * (s.camera * s.guess).inverse).floor


def _offsets(s: Sighting, tag_from_camera: Pose, size: float) -> Array:
    """Pixels between the corners as they should be seen and as they were; far off behind the camera."""
    points = tag_from_camera.points(CORNERS * size / 2)
    points[:, 2] = np.maximum(points[:, 2], 0.05)
    return np.asarray((s.lens.project(points) - s.corners).ravel(), dtype=np.float64)


def _tag_refined(where: Sequence[tuple[FloorPose, Sighting]], tag: Pose, size: float) -> Pose:
    """The tag's pose, in six numbers, that fits all its sightings best."""

    def offsets(pose: Pose) -> Array:
        return np.concatenate([_offsets(s, (Pose.on_floor(p) * s.camera).inverse * pose, size) for p, s in where])

    def moved(by: Array) -> Pose:
        return Pose(tag.at + by[:3], turned_about(by[3:]) @ tag.axes)

    return moved(least_squares(lambda by: offsets(moved(by)), np.zeros(6)).x)
