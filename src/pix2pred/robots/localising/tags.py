"""Tags in a camera's picture: their numbers and corners, found by the AprilTag library (family 36h11)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pix2pred.structs.space.poses import Array, Pose
from pix2pred.system.extras import optional

CORNERS: Array = np.array([(-1.0, 1.0, 0.0), (1.0, 1.0, 0.0), (1.0, -1.0, 0.0), (-1.0, -1.0, 0.0)])
"""The corners of a tag in its own frame (x right and y down for who looks at it) in halves of its side, in the
library's order: from the bottom left on, counter-clockwise as seen."""

LEAST_MARGIN = 20.0
"""The library's measure of how clear the bits are; what is below is rather no tag."""


@dataclass(frozen=True, slots=True)
class Lens:
    """A pinhole camera in pixels."""

    focal: tuple[float, float]
    middle: tuple[float, float]

    def project(self, points: Array) -> Array:
        """Where points seen from the camera, of shape (n, 3), are in the picture, of shape (n, 2)."""
        seen = points[:, :2] / points[:, 2:] * np.array(self.focal) + np.array(self.middle)
        return np.asarray(seen, dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """A tag in a picture: its corners in pixels, and where the camera was, seen from the robot's place."""

    number: int
    corners: Array
    camera: Pose
    lens: Lens
    guess: Pose
    """The library's own estimate of where the tag is, seen from the camera."""


class TagFinder:
    """Finds tags with a side of ``size`` metres (of the black square)."""

    def __init__(self, size: float) -> None:
        self.size = size
        library = optional("pyapriltags", "spot")
        self._detector: Any = library.Detector(families="tag36h11", nthreads=1, quad_decimate=1.0)

    def find(self, grey: NDArray[np.uint8], camera: Pose, lens: Lens) -> list[Sighting]:
        """The tags in a picture, by their numbers."""
        params = (*lens.focal, *lens.middle)
        found = self._detector.detect(np.ascontiguousarray(grey), True, params, self.size)
        sightings = [
            Sighting(
                int(d.tag_id), np.array(d.corners, dtype=float), camera, lens,
                Pose(np.array(d.pose_t, dtype=float).ravel(), np.array(d.pose_R, dtype=float)),
            )
            for d in found
            if d.hamming == 0 and d.decision_margin >= LEAST_MARGIN
        ]  # fmt: skip
        return sorted(sightings, key=lambda s: s.number)
