"""An offscreen camera: pictures of a MuJoCo state with the boxes of objects, found by drawing every geom's number."""

from __future__ import annotations

import atexit
from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.physics.library import OpenGLMissingError, backend, mujoco_library
from pix2pred.structs import Box, Image, Picture, Pixels

SIZE = 480
"""Pixels of a picture's sides."""

LEAST_PIXELS = 24
"""An object of which fewer pixels are seen counts as hidden and gets no box, unless a camera says otherwise."""


class Renderer:
    """Draws states of ``model`` offscreen and without shadows; a camera is a name in the model or an ``MjvCamera``.

    Use it in one thread only. Equal states give equal pixels on one machine. Raises ``OpenGLMissingError`` where it
    cannot draw.
    """

    def __init__(self, model: Any, width: int, height: int) -> None:
        self._mujoco, used = mujoco_library(), backend()
        try:
            self._renderer = self._mujoco.Renderer(model, height, width)
        except Exception as error:  # every backend fails in its own way
            raise OpenGLMissingError(used, error) from error

    def close(self) -> None:
        """Free the OpenGL context."""
        self._renderer.close()

    def pixels(self, data: Any, camera: Any) -> Pixels:
        """What a camera takes."""
        self._look(data, camera)
        return np.array(self._renderer.render(), dtype=np.uint8)

    def numbers(self, data: Any, camera: Any) -> NDArray[np.int32]:
        """The id of the geom seen at every pixel, -1 where there is none."""
        self._renderer.enable_segmentation_rendering()
        try:
            self._look(data, camera)
            seen = np.array(self._renderer.render(), dtype=np.int32)
        finally:
            self._renderer.disable_segmentation_rendering()
        return np.where(seen[..., 1] == int(self._mujoco.mjtObj.mjOBJ_GEOM), seen[..., 0], -1)

    def depth(self, data: Any, camera: Any) -> NDArray[np.float32]:
        """Metres along the camera's axis at every pixel."""
        self._renderer.enable_depth_rendering()
        try:
            self._look(data, camera)
            return np.array(self._renderer.render(), dtype=np.float32)
        finally:
            self._renderer.disable_depth_rendering()

    def _look(self, data: Any, camera: Any) -> None:
        self._renderer.update_scene(data, camera=camera)
        for flag in (self._mujoco.mjtRndFlag.mjRND_SHADOW, self._mujoco.mjtRndFlag.mjRND_REFLECTION):
            self._renderer.scene.flags[flag] = 0


class Camera:
    """Draws states of ``model`` as seen by ``view`` (an ``MjvCamera``), square.

    The OpenGL context is made for the first picture and freed at exit; use a camera in one thread only.
    """

    def __init__(
        self, model: Any, view: Any, name: str = "front", *, least_pixels: Mapping[str, int] = MappingProxyType({})
    ) -> None:
        self.name = name
        self._model = model
        self._view = view
        self._least = least_pixels
        self._renderer: Renderer | None = None

    def picture(self, data: Any, geoms: Mapping[str, Collection[int]]) -> Picture:
        """A picture with boxes around what is seen of the objects. ``geoms`` lists each object's geom ids."""
        pixels, numbers = self.pixels(data), self._open().numbers(data, self._view)
        return Picture(self.name, Image.from_pixels(pixels), boxes_of(numbers, geoms, self._least))

    def pixels(self, data: Any) -> Pixels:
        """The picture alone."""
        return self._open().pixels(data, self._view)

    def close(self) -> None:
        """Free the OpenGL context; the next picture makes a new one."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
            atexit.unregister(self.close)

    def _open(self) -> Renderer:
        if self._renderer is None:
            self._renderer = Renderer(self._model, SIZE, SIZE)
            atexit.register(self.close)
        return self._renderer


def boxes_of(
    numbers: NDArray[np.int32], geoms: Mapping[str, Collection[int]], least: Mapping[str, int] = MappingProxyType({})
) -> dict[str, Box]:
    """The box around every object's visible pixels, if there are enough. ``numbers`` holds a geom id per pixel."""
    names = sorted(geoms)
    owner = np.full(int(numbers.max(initial=0)) + 2, -1, dtype=np.int16)  # the last entry is nobody's
    for i, name in enumerate(names):
        owner[[g for g in geoms[name] if g < len(owner) - 1]] = i
    owners = owner[numbers]
    count = np.bincount(owners.ravel() + 1, minlength=len(names) + 1)[1:]
    shown = (i for i, name in enumerate(names) if count[i] >= least.get(name, LEAST_PIXELS))
    return {names[i]: Box.around(owners == i) for i in shown}
