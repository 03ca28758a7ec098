"""A finer sight for readers of crowded scenes: sharper crops, edges and colours, and neighbours by their type.

Everything is computed from the picture, its boxes and the types of the objects that the prompt lists.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from pix2pred.structs import Box
from pix2pred.vlm.offline.pixels import Scene, Vector, is_blank

TIGHT_SIDE, WIDE_SIDE, EDGE_SIDE = 20, 12, 48
"""Pixels that the three crops of an object are resized to."""

TIGHT, WIDE = 1.15, 2.4
"""Sides of the crops, relative to the longer side of the object's box."""

_CELLS = 6
_NEIGHBOURS = 2
"""Nearest objects of each type that are looked at."""

_PER_NEIGHBOUR = 7


@dataclass(slots=True)
class FineScene(Scene):
    """One picture being read. ``types`` are the prompt's; ``kinds`` the types whose objects count as neighbours."""

    blocks: ClassVar[tuple[int, ...]] = (TIGHT_SIDE**2 * 3, WIDE_SIDE**2 * 3, 3 * _CELLS**2)
    """Near, wide, and edges with saturation in a grid of cells."""
    components: ClassVar[tuple[int, ...]] = (32, 12, 18)

    types: Mapping[str, str] = field(default_factory=dict)
    kinds: Sequence[str] = ()
    _colours: dict[str, Vector] = field(default_factory=dict)

    def _compute_crops(self, name: str) -> Vector | None:
        box = self.box(name)
        if box is None or box.width < 1 or box.height < 1 or is_blank(self.image, box):
            return None
        longest = max(box.width, box.height)
        tight, wide, fine = (
            self._part(box, longest * scale, side)
            for scale, side in ((TIGHT, TIGHT_SIDE), (WIDE, WIDE_SIDE), (TIGHT, EDGE_SIDE))
        )
        self._colours[name] = _strongest_colour(fine)
        return np.concatenate([tight.ravel(), wide.ravel(), _edges(fine)]).astype(np.float32)

    def _part(self, box: Box, side: float, pixels: int) -> Vector:
        x, y = box.center
        area = (round(x - side / 2), round(y - side / 2), round(x + side / 2), round(y + side / 2))
        small = self.image.crop(area).resize((pixels, pixels), PIL.Image.Resampling.BOX)
        part: Vector = np.asarray(small, dtype=np.float32) / np.float32(255)
        return part

    def surroundings(self, name: str) -> Vector:
        """Size and place of the object's box, then the nearest boxes of each type; 0 stands for none."""
        box = self.picture.boxes[name]
        width, height = map(float, self.image.size)
        own = [
            box.width / height, box.height / height, box.center[0] / width - 0.5, box.center[1] / height - 0.5,
            box.width / (box.width + box.height), float(box.left < 2), float(box.right > width - 2),
            float(box.top < 2), float(box.bottom > height - 2),
        ]  # fmt: skip
        for kind in self.kinds:
            others = [b for n, b in sorted(self.picture.boxes.items()) if n != name and self.types.get(n) == kind]
            others.sort(key=lambda other: (-_shared(box, other), _apart(box, other)))
            for k in range(_NEIGHBOURS):
                own += _beside(box, others[k]) if k < len(others) else [0.0] * _PER_NEIGHBOUR
        return np.array(own, dtype=np.float32)

    def relation(self, a: str, b: str) -> Vector:
        """Where box ``b`` lies as seen from box ``a``, in their own sizes, and how like their colours are."""
        first, second = self.picture.boxes[a], self.picture.boxes[b]
        self.crops(a), self.crops(b)
        mine, other = self._colours[a], self._colours[b]
        chosen = max(
            (n for n in sorted(self.picture.boxes) if n != a and self.types.get(n) == self.types.get(b)),
            key=lambda n: (_shared(first, self.picture.boxes[n]), -_apart(first, self.picture.boxes[n])),
        )
        likeness = [*mine, *other, *np.abs(mine - other), float(np.linalg.norm(mine - other))]
        return np.array(
            [*_beside(first, second), *_beside(second, first), float(chosen == b), *likeness], dtype=np.float32
        )


def _shared(a: Box, b: Box) -> float:
    """The share of box ``a`` that lies in box ``b``."""
    wide = min(a.right, b.right) - max(a.left, b.left)
    high = min(a.bottom, b.bottom) - max(a.top, b.top)
    return max(0.0, wide) * max(0.0, high) / (a.width * a.height)


def _apart(a: Box, b: Box) -> float:
    return float(np.hypot(a.center[0] - b.center[0], a.center[1] - b.center[1]))


def _beside(a: Box, b: Box) -> list[float]:
    """Where ``a`` is, measured by ``b``: shared area, offsets of middle, top and bottom, relative size, presence."""
    return [
        _shared(a, b),
        float(np.clip((a.center[0] - b.center[0]) / b.width, -3, 3)),
        float(np.clip((a.center[1] - b.center[1]) / b.height, -3, 3)),
        float(np.clip((a.bottom - b.bottom) / b.height, -3, 3)),
        float(np.clip((a.top - b.top) / b.height, -3, 3)),
        float(np.clip(np.log(a.width * a.height / (b.width * b.height)) / 4, -1.5, 1.5)),
        1.0,
    ]


def _edges(crop: Vector) -> Vector:
    """Mean strength of vertical and horizontal edges, and mean saturation, in a grid of cells."""
    grey = crop.mean(axis=2)
    across = np.abs(np.diff(grey, axis=1, append=grey[:, -1:]))
    down = np.abs(np.diff(grey, axis=0, append=grey[-1:]))
    saturation = crop.max(axis=2) - crop.min(axis=2)
    cell = EDGE_SIDE // _CELLS
    planes: NDArray[np.float32] = np.stack([4 * across, 4 * down, saturation])
    cells: Vector = planes.reshape(3, _CELLS, cell, _CELLS, cell).mean(axis=(2, 4)).ravel()
    return cells


def _strongest_colour(crop: Vector) -> Vector:
    """The mean colour of the most saturated tenth of the crop's middle, relative to its brightest channel."""
    quarter = EDGE_SIDE // 6
    middle = crop[quarter:-quarter, quarter:-quarter].reshape(-1, 3)
    saturation = middle.max(axis=1) - middle.min(axis=1)
    strongest = np.argsort(saturation)[-len(middle) // 10 :]
    colour = middle[strongest].mean(axis=0)
    relative: Vector = (colour / max(float(colour.max()), 1e-3)).astype(np.float32)
    return relative
