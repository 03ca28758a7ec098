"""Undoing the angle at which a camera is mounted, so that up in the world is up in the picture (method 10.6)."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from pix2pred.structs import Pixels

Number = TypeVar("Number", float, NDArray[np.float64])

_CUT = 0.11
"""Share cut off at every side after a turn by 12 degrees: no empty corners are left at the middles of the sides."""


def upright(pixels: Pixels, angle: int) -> Pixels:
    """A picture turned counter-clockwise by ``angle`` degrees.

    Quarter turns lose nothing; after any other one, corners that the camera did not see are cut off, not filled.
    """
    quarter, rest = _turns(angle)
    turned = np.rot90(pixels, quarter)
    if rest == 0:
        return np.ascontiguousarray(turned)
    image = PIL.Image.fromarray(np.ascontiguousarray(turned)).rotate(rest, PIL.Image.Resampling.BILINEAR)
    return np.ascontiguousarray(np.asarray(image)[_cut(turned.shape)])


def upright_numbers(numbers: NDArray[np.int32], angle: int) -> NDArray[np.int32]:
    """A number per pixel turned in the same way; -1 where the camera saw nothing."""
    quarter, rest = _turns(angle)
    turned = np.ascontiguousarray(np.rot90(numbers, quarter))
    if rest == 0:
        return turned
    image = PIL.Image.fromarray(turned, mode="I").rotate(rest, PIL.Image.Resampling.NEAREST, fillcolor=-1)
    return np.asarray(image, dtype=np.int32)[_cut(turned.shape)]


def before_turning(x: Number, y: Number, size: tuple[int, int], angle: int) -> tuple[Number, Number]:
    """Where points of the upright picture are in the picture as taken, whose (width, height) is ``size``."""
    quarter, rest = _turns(angle)
    width, height = size if quarter % 2 == 0 else (size[1], size[0])
    if rest:
        rows, columns = _cut((height, width))
        cos, sin = math.cos(math.radians(rest)), math.sin(math.radians(rest))
        dx, dy = x + columns.start - width / 2, y + rows.start - height / 2
        x, y = width / 2 + cos * dx - sin * dy, height / 2 + sin * dx + cos * dy
    for _ in range(quarter % 4):
        x, y, width, height = height - y, x, height, width
    return x, y


def _turns(angle: int) -> tuple[int, int]:
    """Quarter turns, and the degrees that are left."""
    quarter = round(angle / 90)
    return quarter, angle - 90 * quarter


def _cut(shape: tuple[int, ...]) -> tuple[slice, slice]:
    height, width = shape[:2]
    return (
        slice(round(_CUT * height), round((1 - _CUT) * height)),
        slice(round(_CUT * width), round((1 - _CUT) * width)),
    )
