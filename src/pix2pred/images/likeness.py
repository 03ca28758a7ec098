"""How alike two pictures are: whether anything can have happened between them."""

from __future__ import annotations

import numpy as np
import PIL.Image

from pix2pred.structs import Pixels

SIDE = 96
"""Pixels of the square that pictures are reduced to before they are compared: noise averages out, things stay."""

MOST_ALIKE = 0.006
"""Share of the square that may differ in two photos of an untouched scene (a shadow, a flicker)."""

VISIBLE = 24
"""Grey levels of 256 that count as a difference; noise of a phone's camera stays below 10 after the reduction."""


def nearly_same(one: Pixels, other: Pixels) -> bool:
    """Whether two pictures, shape (height, width, 3), show the same but for noise; other sizes are never the same."""
    if one.shape != other.shape:
        return False
    if np.array_equal(one, other):
        return True
    differs = np.abs(_reduced(one) - _reduced(other)).max(axis=-1) > VISIBLE
    return bool(differs.mean() <= MOST_ALIKE)


def _reduced(pixels: Pixels) -> np.ndarray[tuple[int, ...], np.dtype[np.int16]]:
    small = PIL.Image.fromarray(pixels).resize((SIDE, SIDE), PIL.Image.Resampling.BOX)
    return np.asarray(small, dtype=np.int16)
