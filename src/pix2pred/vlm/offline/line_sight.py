"""A sight for readers that tell whether something is drawn on a surface: thin dark or coloured lines, box by box.

Lines of a marker vanish in a crop of a whole table that is made small; here they are looked for at full resolution.
Everything is computed from the picture, its boxes and the types of the objects that the prompt lists.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from pix2pred.structs import Box
from pix2pred.vlm.offline.fine_sight import FineScene
from pix2pred.vlm.offline.pixels import Vector

Grey = NDArray[np.uint8]

_WIDEST = 11
"""Lines up to this many pixels wide are found; what is wider is a thing or a surface."""

_DARKER = (0.10, 0.22, 0.40)
"""How much darker than what is around it, in its darkest channel, a pixel of a line is."""

_ROWS, _COLUMNS = 4, 5
"""Cells of a box in which the share of such pixels is measured."""

_LONGEST = 320
"""Larger boxes are made so small (pixels of the longer side)."""


@dataclass(slots=True)
class LineScene(FineScene):
    """One picture being read, with an eye on what is drawn on things of the types ``drawn_on``."""

    drawn_on: Sequence[str] = ()
    _lines: dict[str, Vector] = field(default_factory=dict)

    def _compute_crops(self, name: str) -> Vector | None:
        crops = FineScene._compute_crops(self, name)
        if crops is not None and self.types.get(name) in self.drawn_on:
            self._lines[name] = self._drawn(self.picture.boxes[name])
        return crops

    def surroundings(self, name: str) -> Vector:
        """As with the finer sight, then, where it may be drawn on, how much of every part of the box lines cover."""
        self.crops(name)
        found = FineScene.surroundings(self, name)
        return np.concatenate([found, self._lines[name]]) if name in self._lines else found

    def _drawn(self, box: Box) -> Vector:
        part = self.image.crop((round(box.left), round(box.top), round(box.right), round(box.bottom)))
        if max(part.size) > _LONGEST:
            part.thumbnail((_LONGEST, _LONGEST), PIL.Image.Resampling.BOX)
        darkest: Grey = np.asarray(part).min(axis=2)
        around = 255 - _brightest(255 - _brightest(darkest))
        depth = (around - darkest).astype(np.float32) / np.float32(255)
        rows = np.array_split(depth, _ROWS)
        cells = [cell for row in rows for cell in np.array_split(row, _COLUMNS, axis=1)]
        shares = [[float((cell > least).mean()) if cell.size else 0.0 for least in _DARKER] for cell in cells]
        whole = [float((depth > least).mean()) for least in _DARKER]
        return np.array([*(share for cell in shares for share in cell), *whole], dtype=np.float32)


def _brightest(image: Grey) -> Grey:
    """The largest value within half of ``_WIDEST`` pixels of every pixel, in a square."""
    for axis in (0, 1):
        padded = np.pad(image, [(_WIDEST // 2,) * 2 if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        image = np.lib.stride_tricks.sliding_window_view(padded, _WIDEST, axis=axis).max(axis=-1)
    return image
