"""Numbers computed from a part of a picture: colours near and around it, gradients, and where it lies.

Everything is a function of pixels and boxes. A part is a square about a box, of the box's longer side times a factor,
resampled with sub-pixel accuracy, so that equal things at different places give equal numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from pix2pred.structs import Box

Array = NDArray[np.float32]

NEAR_SIDE, AROUND_SIDE = 32, 16
"""Pixels to which the near and the wide part are resampled."""
NEAR, AROUND = 1.15, 2.4
"""Sides of the two parts, relative to the longer side of the box."""
ORIENTATIONS, CELLS = 8, 4
"""Gradients are counted by orientation in a grid of CELLS x CELLS cells."""
_OCTANTS = np.array([0, 1, 3, 2, 7, 6, 4, 5])
"""The eighth of a turn in which a gradient points: by whether it goes up, goes left, and is steep."""
FINE = 2
"""Pixels, in width and height, of which each pixel of a part is the mean at least."""

PARTS: Mapping[str, int] = {
    "near": (NEAR_SIDE // 2) ** 2 * 3,
    "around": AROUND_SIDE**2 * 3,
    "edges": ORIENTATIONS * CELLS**2,
    "place": 6,
}
"""What is computed of a box, and how many numbers each part has."""
_FRAMES = [*np.cumsum(list(PARTS.values()))[:-1]]
LENGTH = sum(PARTS.values())


@dataclass(frozen=True, slots=True)
class Augmentation:
    """A change of a picture that keeps what it shows.

    ``dx`` and ``dy`` shift the box by a share of its side, ``scale`` makes it larger; ``brightness`` is added to all
    values from 0 to 1, and ``contrast`` stretches them.
    """

    dx: float = 0.0
    dy: float = 0.0
    scale: float = 1.0
    """Of the box's sides, around its middle: above 1 more of what
    lies around it is seen."""
    brightness: float = 0.0
    contrast: float = 1.0


UNCHANGED = Augmentation()


def split(vectors: Array) -> dict[str, Array]:
    """The parts of vectors of shape (..., LENGTH)."""
    return dict(zip(PARTS, np.split(vectors, _FRAMES, axis=-1), strict=True))


@dataclass(frozen=True, slots=True)
class PicturePyramid:
    """A picture, and coarser copies of it, each of half the size of the one before, made when they are needed."""

    copies: list[PIL.Image.Image]

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        return self.copies[0].size

    def copy(self, halvings: int) -> PIL.Image.Image:
        """The picture, reduced by half so many times."""
        while len(self.copies) <= halvings:
            self.copies.append(self.copies[-1].reduce(2))
        return self.copies[halvings]

    def square(self, center: tuple[float, float], half: float, side: int) -> Array:
        """A square of the picture as ``side`` times ``side`` pixels of values from 0 to 1; black outside the picture.

        It is cut from the coarsest copy that has at least ``FINE`` pixels for each of them.
        """
        halvings = max(0, math.frexp(2 * half / (FINE * side))[1] - 1)
        (x, y), half = (center[0] / 2**halvings, center[1] / 2**halvings), half / 2**halvings
        left, top = int(np.floor(x - half)), int(np.floor(y - half))
        right, bottom = int(np.ceil(x + half)), int(np.ceil(y + half))
        exact = (x - half - left, y - half - top, x + half - left, y + half - top)
        cut = self.copy(halvings).crop((left, top, right, bottom))
        part: Array = np.asarray(cut.resize((side, side), PIL.Image.Resampling.BOX, exact), dtype=np.float32)
        part /= np.float32(255)
        return part


def see(picture: PicturePyramid, boxes: Sequence[Box], changes: Sequence[Augmentation]) -> Array:
    """One vector of ``LENGTH`` numbers for each box, seen through the change beside it."""
    if not boxes:
        return np.zeros((0, LENGTH), dtype=np.float32)
    moved = [_moved(box, change) for box, change in zip(boxes, changes, strict=True)]
    halves = [max(box.width, box.height, 1.0) / 2 for box in moved]
    near, around = (
        np.stack([picture.square(b.center, half * factor, side) for b, half in zip(moved, halves, strict=True)])
        for factor, side in ((NEAR, NEAR_SIDE), (AROUND, AROUND_SIDE))
    )
    light = np.array([(c.contrast, c.brightness) for c in changes], dtype=np.float32)[:, :, None, None, None]
    near, around = ((part - 0.5) * light[:, 0] + 0.5 + light[:, 1] for part in (near, around))
    place = np.array([_place(box, picture.size) for box in moved], dtype=np.float32)
    flat = (_halved(near), around, _edges(near), place)
    return np.concatenate([part.reshape(len(boxes), -1) for part in flat], axis=1, dtype=np.float32)


def _moved(box: Box, change: Augmentation) -> Box:
    side = max(box.width, box.height)
    x, y = box.center[0] + change.dx * side, box.center[1] + change.dy * side
    width, height = box.width * change.scale / 2, box.height * change.scale / 2
    return Box(x - width, y - height, x + width, y + height)


def _halved(parts: Array) -> Array:
    n, side = parts.shape[0], parts.shape[1] // 2
    halved: Array = parts.reshape(n, side, 2, side, 2, 3).mean(axis=(2, 4))
    return halved


def _edges(parts: Array) -> Array:
    """Strength of gradients by orientation and cell; the square root evens out strong and weak ones."""
    grey = parts.mean(axis=3)
    across, down = np.zeros_like(grey), np.zeros_like(grey)
    across[:, :, 1:-1] = grey[:, :, 2:] - grey[:, :, :-2]
    down[:, 1:-1] = grey[:, 2:] - grey[:, :-2]
    strength = np.sqrt(across**2 + down**2)
    number = _OCTANTS[(down < 0) * 4 + (across < 0) * 2 + (np.abs(down) > np.abs(across))]
    n, side = grey.shape[0], grey.shape[1]
    cell = np.arange(side) * CELLS // side
    where = (np.arange(n)[:, None, None] * CELLS + cell[None, :, None]) * CELLS + cell[None, None, :]
    bins = (where * ORIENTATIONS + number).ravel()
    counted = np.bincount(bins, strength.ravel(), minlength=n * CELLS**2 * ORIENTATIONS)
    edges: Array = np.sqrt(counted / (side / CELLS) ** 2).astype(np.float32)
    return edges.reshape(n, -1)


def _place(box: Box, size: tuple[int, int]) -> tuple[float, ...]:
    """Size and middle of the box relative to the picture's height, its shape, and how much of it is cut off."""
    width, height = size
    inside = max(0.0, min(box.right, width) - max(box.left, 0.0)) * max(
        0.0, min(box.bottom, height) - max(box.top, 0.0)
    )
    shape = box.width / max(box.width + box.height, 1e-6)
    covered = inside / max(box.width * box.height, 1e-6)
    x, y = box.center
    return (box.width / height, box.height / height, x / height, y / height, shape, covered)
