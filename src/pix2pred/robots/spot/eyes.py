"""Pictures from the robot's cameras, upright, and distances, each with the place of its camera."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import PIL.Image
from bosdyn.api import image_pb2
from bosdyn.client.exceptions import TimedOutError
from bosdyn.client.image import build_image_request
from numpy.typing import NDArray

from pix2pred.images.upright import before_turning, upright
from pix2pred.robots.localising.tags import Lens
from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.frames import BODY, ODOM, seen_from
from pix2pred.robots.spot.link import named
from pix2pred.robots.spot.session import SpotSession
from pix2pred.robots.spot.settings import HAND_CAMERA
from pix2pred.structs import Pixels
from pix2pred.structs.space.poses import Array, Pose

TRIES = 2
"""Times a silent camera is asked."""

_RGB, _GREY = image_pb2.Image.PIXEL_FORMAT_RGB_U8, image_pb2.Image.PIXEL_FORMAT_GREYSCALE_U8


@dataclass(frozen=True, slots=True, eq=False)
class CameraShot:
    """A picture as the camera is mounted. ``camera`` is seen from the body, ``body`` from the odometry's frame."""

    source: str
    pixels: NDArray[Any]
    lens: Lens
    camera: Pose
    body: Pose
    response: Any

    @property
    def name(self) -> str:
        """The camera's name without the kind of its pictures."""
        return self.source.removesuffix("_image")

    @property
    def turn(self) -> int:
        """Degrees by which the picture is to be turned counter-clockwise to be upright; the hand's is as it is."""
        return 0 if self.source == HAND_CAMERA else roll_of(self.camera.axes)

    def upright(self) -> Pixels:
        """The picture, upright."""
        return upright(self.pixels, self.turn)

    def raw_points(self, x: NDArray[Any], y: NDArray[Any]) -> Array:
        """Points of the upright picture in the picture as taken, of shape (n, 2)."""
        height, width = self.pixels.shape[:2]
        return np.column_stack(before_turning(x, y, (width, height), self.turn))


def roll_of(axes: Array) -> int:
    """Whole degrees by which a camera is turned about its own axis, from where its x and y axes point."""
    ahead = axes[:, 2]
    level = np.cross(ahead, (0.0, 0.0, 1.0))  # to the right of one who looks ahead, head up
    level /= np.linalg.norm(level)
    up = np.cross(level, ahead)
    right = axes[:, 0]
    return round(math.degrees(math.atan2(float(right @ up), float(right @ level)))) % 360


class Eyes:
    """Asks for pictures. Raises ``RobotError`` when a camera stays silent."""

    def __init__(self, session: SpotSession) -> None:
        self._session = session

    def shots(self, sources: Sequence[str], *, grey: bool = False) -> Mapping[str, CameraShot]:
        """One picture of each source, taken at the same time."""
        wanted = [
            build_image_request(
                s,
                image_format=image_pb2.Image.FORMAT_RAW,
                pixel_format=None if "_depth_in_" in s else _GREY if grey else _RGB,
            )
            for s in sources
        ]
        return {r.source.name: _shot(r) for r in self._asked(wanted, sources)}

    def _asked(self, wanted: Sequence[Any], sources: Sequence[str]) -> Sequence[Any]:
        client = self._session.client("image")
        for _ in range(TRIES):
            with named(f"pictures of {', '.join(sources)}", self._session.why):
                try:
                    responses: Sequence[Any] = client.get_image(wanted, timeout=self._session.settings.deadlines.answer)
                    return responses
                except TimedOutError:
                    self._session.check()
        raise RobotError(
            Outcome.CAMERA_SILENT,
            f"{TRIES} times no picture within {self._session.settings.deadlines.answer:g} s of {', '.join(sources)}",
        )


def _shot(response: Any) -> CameraShot:
    image, shot = response.shot.image, response.shot
    lens = response.source.pinhole.intrinsics
    tree = shot.transforms_snapshot
    return CameraShot(
        response.source.name,
        _decoded(image),
        Lens((lens.focal_length.x, lens.focal_length.y), (lens.principal_point.x, lens.principal_point.y)),
        seen_from(tree, BODY, shot.frame_name_image_sensor),
        seen_from(tree, ODOM, BODY),
        response,
    )


def _decoded(image: Any) -> NDArray[Any]:
    if image.pixel_format == image.PIXEL_FORMAT_DEPTH_U16:
        return np.frombuffer(image.data, dtype="<u2").reshape(image.rows, image.cols)
    if image.format == image.FORMAT_RAW:
        flat = np.frombuffer(image.data, dtype=np.uint8)
        channels = len(flat) // (image.rows * image.cols)
        pixels = flat.reshape(image.rows, image.cols, channels)
        return pixels[..., 0] if channels == 1 else pixels[..., :3]
    return np.asarray(PIL.Image.open(io.BytesIO(image.data)))
