"""Which object is where: boxes and outlines in upright pictures, and from distances, points in the map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from bosdyn.api import network_compute_bridge_pb2 as bridge
from numpy.typing import NDArray

from pix2pred.images.upright import upright_numbers
from pix2pred.robots.detecting.detector import Detector, Mask, Segmenter, best_boxes, whole_box
from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.eyes import CameraShot
from pix2pred.robots.spot.link import named
from pix2pred.robots.spot.session import SpotSession
from pix2pred.structs import Box, Image, Object
from pix2pred.structs.space.poses import Array, Pose

LEAST_PIXELS = 60
"""An object of which fewer pixels are seen counts as hidden."""

MOST_POINTS = 6000
"""Points taken of an object's outline."""


@dataclass(frozen=True, slots=True)
class Outlines:
    """The objects in an upright picture: their boxes, and their pixels."""

    boxes: Mapping[str, Box] = field(default_factory=dict)
    masks: Mapping[str, Mask] = field(default_factory=dict)


class Outliner(Protocol):
    """Finds the objects of a task in a picture."""

    def find(self, shot: CameraShot, objects: Sequence[Object]) -> Outlines:
        """Boxes and pixels, as far as they are seen."""
        ...


class ByWords:
    """Any detector, asked one description at a time, and any segmenter; without one, boxes are all there is."""

    def __init__(self, detector: Detector, segmenter: Segmenter | None = None) -> None:
        self._detector, self._segmenter = detector, segmenter

    def find(self, shot: CameraShot, objects: Sequence[Object]) -> Outlines:
        picture = Image.from_pixels(shot.upright())
        descriptors = {o.name: o.descriptor for o in objects}
        found = [d for words in sorted(set(descriptors.values())) for d in self._detector.detect(picture, [words])]
        boxes = best_boxes(found, descriptors)
        names = sorted(boxes)
        if self._segmenter is None:
            masks: Sequence[Mask] = [whole_box(picture.size, boxes[n]) for n in names]
        else:
            masks = self._segmenter.segment(picture, [boxes[n] for n in names])
        return Outlines(boxes, dict(zip(names, masks, strict=True)))


_NUMBERS = "objects"
"""The picture of a bridge's answer in which every pixel has the identifier of the object seen there."""


class ByBridge:
    """A detector that runs beside the robot, behind its network-compute bridge; labels are the objects' names."""

    def __init__(self, session: SpotSession, model: str) -> None:
        self._session, self._model = session, model

    def find(self, shot: CameraShot, objects: Sequence[Object]) -> Outlines:
        request = bridge.NetworkComputeRequest()
        request.input_data.image_source_and_service.image_source = shot.source
        request.input_data.model_name = self._model
        request.server_config.service_name = self._model
        with named("detecting objects", self._session.why):
            client = self._session.client("network-compute-bridge")
            answer: Any = client.network_compute_bridge_command(
                request, timeout=self._session.settings.deadlines.answer
            )
        if _NUMBERS not in answer.output_images:
            raise RobotError(Outcome.NOT_READY, f"the model {self._model!r} of the bridge gives no outlines")
        image = answer.output_images[_NUMBERS].image_response.shot.image
        numbers = np.frombuffer(image.data, dtype=np.uint8).reshape(image.rows, image.cols).astype(np.int32)
        turned = upright_numbers(numbers, shot.turn)
        wanted = {o.name for o in objects}
        masks = {o.name: turned == o.id for o in answer.object_in_image if o.name in wanted}
        masks = {name: mask for name, mask in masks.items() if int(mask.sum()) >= LEAST_PIXELS}
        return Outlines({name: Box.around(mask) for name, mask in masks.items()}, masks)


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """Points of an object in the map, and the pixel of a picture as taken where each was seen."""

    name: str
    shot: CameraShot
    points: Array
    pixels: Array

    @property
    def top(self) -> float:
        """The height of its top."""
        return float(np.percentile(self.points[:, 2], 98))

    def extent(self, *, within: float | None = None) -> tuple[Array, Array]:
        """The lowest and highest x and y of its points, or of those at most ``within`` under its top."""
        points = self.points if within is None else self.points[self.points[:, 2] >= self.top - within]
        low, high = np.percentile(points[:, :2], [1, 99], axis=0)
        return low, high

    def middle(self, *, within: float | None = None) -> Array:
        """The middle of its extent along the floor."""
        low, high = self.extent(within=within)
        return np.asarray((low + high) / 2)

    def pixel_near(self, point: Array) -> tuple[float, float]:
        """The pixel of the point that is nearest to a place in the map."""
        i = int(np.argmin(np.linalg.norm(self.points - np.asarray(point), axis=1)))
        return float(self.pixels[i, 0]), float(self.pixels[i, 1])

    def inner_pixel(self) -> tuple[float, float]:
        """A pixel well within the outline: the one nearest to the median."""
        i = int(np.argmin(np.linalg.norm(self.pixels - np.median(self.pixels, axis=0), axis=1)))
        return float(self.pixels[i, 0]), float(self.pixels[i, 1])


def points_of(
    name: str, shot: CameraShot, depth: NDArray[Any], scale: float, mask: Mask, map_from_body: Pose
) -> Found | None:
    """The points of an object, from the pixels of its outline that have a distance; None when there are none."""
    rows, columns = np.nonzero(mask)
    step = max(1, len(rows) // MOST_POINTS)
    raw = shot.raw_points(columns[::step] + 0.5, rows[::step] + 0.5)
    height, width = depth.shape
    inside = (raw[:, 0] >= 0) & (raw[:, 0] < width) & (raw[:, 1] >= 0) & (raw[:, 1] < height)
    raw = raw[inside]
    far = depth[raw[:, 1].astype(int), raw[:, 0].astype(int)].astype(float) / scale
    raw, far = raw[far > 0], far[far > 0]
    if not len(raw):
        return None
    flat = (raw - np.array(shot.lens.middle)) / np.array(shot.lens.focal)
    seen = np.column_stack([flat * far[:, None], far])
    return Found(name, shot, (map_from_body * shot.camera).points(seen), raw)
