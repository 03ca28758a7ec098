"""The pictures of a world: one through a person's eyes, or six through the robot's cameras, upright, with boxes."""

from __future__ import annotations

import atexit
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.home.drawing.bodies import MOUNTS
from pix2pred.domains.home.drawing.maker import HEIGHT, WIDTH
from pix2pred.domains.home.stage import PhysicalScene, scene_key, stage_for
from pix2pred.domains.home.world import Body, World
from pix2pred.domains.physics import OpenGLMissingError, mujoco_library
from pix2pred.domains.physics.library import backend
from pix2pred.images.upright import upright, upright_numbers
from pix2pred.structs import Box, Image, Picture, Pixels

LEAST_PIXELS = 60
"""An object of which fewer pixels are seen counts as hidden and gets no box."""

_KEPT = 2
_UPRIGHT = {m.name: round(m.roll) for m in MOUNTS}


class Eye:
    """Draws the states of one scene. The OpenGL context is made for the first picture."""

    def __init__(self, stage: PhysicalScene) -> None:
        mujoco, used = mujoco_library(), backend()
        self._mujoco = mujoco
        self.stage = stage
        try:
            self._renderer = mujoco.Renderer(stage.model, HEIGHT, WIDTH)
        except Exception as error:  # every backend fails in its own way
            raise OpenGLMissingError(used, error) from error

    def close(self) -> None:
        """Free the OpenGL context."""
        self._renderer.close()

    def pixels(self, camera: str) -> Pixels:
        """What a camera takes, not yet turned upright."""
        self._look(camera)
        return np.array(self._renderer.render(), dtype=np.uint8)

    def numbers(self, camera: str) -> NDArray[np.int32]:
        """The geom seen at every pixel, -1 where there is none."""
        self._renderer.enable_segmentation_rendering()
        self.stage.clear_glass(hidden=True)  # what is seen through it is seen
        try:
            self._look(camera)
            seen = np.array(self._renderer.render(), dtype=np.int32)
        finally:
            self._renderer.disable_segmentation_rendering()
            self.stage.clear_glass(hidden=False)
        return np.where(seen[..., 1] == int(self._mujoco.mjtObj.mjOBJ_GEOM), seen[..., 0], -1)

    def _look(self, camera: str) -> None:
        self._renderer.update_scene(self.stage.data, camera=camera)
        for flag in (self._mujoco.mjtRndFlag.mjRND_SHADOW, self._mujoco.mjtRndFlag.mjRND_REFLECTION):
            self._renderer.scene.flags[flag] = 0


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
    return Picture(camera, Image.from_pixels(pixels), _boxes(numbers, eye.stage.objects(world)))


def _boxes(numbers: NDArray[np.int32], geoms: Mapping[str, Sequence[int]]) -> dict[str, Box]:
    """The box around every object's visible pixels, if there are enough."""
    names = sorted(geoms)
    owner = np.full(int(numbers.max(initial=0)) + 2, -1, dtype=np.int16)  # the last entry is nobody's
    for i, name in enumerate(names):
        owner[[g for g in geoms[name] if g < len(owner) - 1]] = i
    owners = owner[numbers]
    count = np.bincount(owners.ravel() + 1, minlength=len(names) + 1)[1:]
    boxes = {}
    for i, name in enumerate(names):
        if count[i] >= LEAST_PIXELS:
            rows, columns = (np.flatnonzero((owners == i).any(axis=axis)) for axis in (1, 0))
            boxes[name] = Box(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))
    return boxes


def pixels_of(world: World, camera: str) -> Pixels:
    """The pixels of one camera's picture alone."""
    eye = _eye(world)
    eye.stage.pose(world)
    return upright(eye.pixels(camera), _UPRIGHT.get(camera, 0))
