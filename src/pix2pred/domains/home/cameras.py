"""The pictures of a world: one through a person's eyes, or six through the robot's cameras, upright, with boxes."""

from __future__ import annotations

import atexit
from collections import OrderedDict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.home.drawing.bodies import HEIGHT, MOUNTS, WIDTH
from pix2pred.domains.home.stage import PhysicalScene, scene_key, stage_for
from pix2pred.domains.home.world import Body, World
from pix2pred.domains.physics import Renderer, boxes_of
from pix2pred.images.upright import upright, upright_numbers
from pix2pred.structs import Image, Picture, Pixels

LEAST_PIXELS = 60
"""An object of which fewer pixels are seen counts as hidden and gets no box."""

_KEPT = 2
_UPRIGHT = {m.name: round(m.roll) for m in MOUNTS}


class Eye:
    """Draws the states of one scene. The OpenGL context is made for the first picture."""

    def __init__(self, stage: PhysicalScene) -> None:
        self.stage = stage
        self._renderer = Renderer(stage.model, WIDTH, HEIGHT)

    def close(self) -> None:
        """Free the OpenGL context."""
        self._renderer.close()

    def pixels(self, camera: str) -> Pixels:
        """What a camera takes, not yet turned upright."""
        return self._renderer.pixels(self.stage.data, camera)

    def numbers(self, camera: str) -> NDArray[np.int32]:
        """The geom seen at every pixel, -1 where there is none; clear glass is seen through."""
        with self.stage.without_glass():
            return self._renderer.numbers(self.stage.data, camera)

    def depth(self, camera: str) -> NDArray[np.float32]:
        """Metres along the camera's axis at every pixel; clear glass is seen through."""
        with self.stage.without_glass():
            return self._renderer.depth(self.stage.data, camera)


_EYES: OrderedDict[tuple[Any, ...], Eye] = OrderedDict()


def _eye(world: World) -> Eye:
    key = scene_key(world)
    stage = stage_for(world)
    if key in _EYES and _EYES[key].stage is not stage:
        _EYES.pop(key).close()
    if key not in _EYES:
        if not _EYES:
            atexit.unregister(_close_all)
            atexit.register(_close_all)
        _EYES[key] = Eye(stage)
        if len(_EYES) > _KEPT:
            _EYES.popitem(last=False)[1].close()
    _EYES.move_to_end(key)
    return _EYES[key]


def _close_all() -> None:
    while _EYES:
        _EYES.popitem()[1].close()


def camera_names(world: World) -> tuple[str, ...]:
    """The cameras that look at ``world``."""
    return ("head",) if world.body is Body.HUMAN else tuple(m.name for m in MOUNTS)


def pictures(world: World) -> tuple[Picture, ...]:
    """One picture a camera, with boxes around what is seen of the objects."""
    return tuple(picture(world, name) for name in camera_names(world))


def picture(world: World, camera: str) -> Picture:
    """The picture of one camera."""
    eye = _eye(world)
    eye.stage.pose(world)
    pixels = upright(eye.pixels(camera), _UPRIGHT.get(camera, 0))
    numbers = upright_numbers(eye.numbers(camera), _UPRIGHT.get(camera, 0))
    objects = eye.stage.objects(world)
    return Picture(camera, Image.from_pixels(pixels), boxes_of(numbers, objects, dict.fromkeys(objects, LEAST_PIXELS)))


def pixels_of(world: World, camera: str) -> Pixels:
    """The pixels of one camera's picture alone."""
    eye = _eye(world)
    eye.stage.pose(world)
    return upright(eye.pixels(camera), _UPRIGHT.get(camera, 0))
