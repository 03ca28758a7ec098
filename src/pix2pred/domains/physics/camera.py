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


class Camera:
    """Draws states of ``model`` as seen by ``view`` (an ``MjvCamera``), square and without shadows.

    The OpenGL context is made for the first picture and freed at exit; use a camera in one thread only. Equal states
    give equal pixels on one machine. Drawing raises ``OpenGLMissingError`` where it is not possible.
    """

    def __init__(
        self,
        model: Any,
        view: Any,
        name: str = "front",
        size: int = SIZE,
        *,
        least_pixels: Mapping[str, int] = MappingProxyType({}),
    ) -> None:
        self.name = name
        self._model = model
        self._view = view
        self._size = size
        self._least = least_pixels
        self._renderer: Any = None

    def picture(self, data: Any, geoms: Mapping[str, Collection[int]]) -> Picture:
        """A picture with boxes around what is seen of the objects. ``geoms`` lists each object's geom ids."""
        pixels = self.pixels(data)
        return Picture(self.name, Image.from_pixels(pixels), boxes_of(self._numbers(data), geoms, self._least))

    def pixels(self, data: Any) -> Pixels:
        """The picture alone."""
        renderer = self._open()
        self._look(renderer, data)
        return np.array(renderer.render(), dtype=np.uint8)

    def close(self) -> None:
        """Free the OpenGL context; the next picture makes a new one."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
            atexit.unregister(self.close)

    def _numbers(self, data: Any) -> NDArray[np.int32]:
        """The id of the geom seen at every pixel, -1 where there is none."""
        mujoco, renderer = mujoco_library(), self._open()
        renderer.enable_segmentation_rendering()
        try:
            self._look(renderer, data)
            seen = np.array(renderer.render(), dtype=np.int32)
        finally:
            renderer.disable_segmentation_rendering()
        return np.where(seen[..., 1] == int(mujoco.mjtObj.mjOBJ_GEOM), seen[..., 0], -1)

    def _look(self, renderer: Any, data: Any) -> None:
        mujoco = mujoco_library()
        renderer.update_scene(data, camera=self._view)
        for flag in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION):
            renderer.scene.flags[flag] = 0

    def _open(self) -> Any:
        if self._renderer is None:
            mujoco, used = mujoco_library(), backend()
            try:
                self._renderer = mujoco.Renderer(self._model, self._size, self._size)
            except Exception as error:  # every backend fails in its own way
                raise OpenGLMissingError(used, error) from error
            atexit.register(self.close)
        return self._renderer


def boxes_of(
    numbers: NDArray[np.int32], geoms: Mapping[str, Collection[int]], least: Mapping[str, int] = MappingProxyType({})
) -> dict[str, Box]:
    """The box around every object's visible pixels, if there are enough. ``numbers`` holds a geom id per pixel."""
    boxes = {}
    for name in sorted(geoms):
        rows, columns = np.nonzero(np.isin(numbers, list(geoms[name])))
        if len(rows) >= least.get(name, LEAST_PIXELS):
            boxes[name] = Box(float(columns.min()), float(rows.min()), float(columns.max() + 1), float(rows.max() + 1))
    return boxes
