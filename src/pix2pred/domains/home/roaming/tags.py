"""AprilTags (family 36h11) on the walls: a body whose picture says which it is and where it is seen from."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.home.drawing.room import WALL
from pix2pred.domains.physics import Maker

CELLS = 10
"""Cells along a side of a printed tag: six of code, one of black border around them and one of white around that."""

BORDER = 8
"""Cells along the black square, which is what the size of a tag means."""

SIZE = 0.30
"""Side of the black square in metres: 30 pixels at four metres in the cameras here, found from every pose tried."""

_CODES = (0xD5D628584, 0xD97F18B49, 0xDD280910E, 0xE479E9C98, 0xEBCBCA822, 0xF31DAB3AC)
"""The six times six bits of the tags 0 to 5 of the family, row by row, white is 1 (as its authors publish them)."""

_OFF_THE_WALL = 0.085
"""Metres between the wall's middle and a tag: it hangs in front of pictures' frames and skirting."""


@dataclass(frozen=True, slots=True)
class WallTag:
    """A tag's number, the middle of its face in the room, and the direction (radians) that its face looks to."""

    number: int
    at: tuple[float, float, float]
    facing: float


_BACK = -WALL - 0.8
TAGS: Sequence[WallTag] = (
    WallTag(0, (WALL - _OFF_THE_WALL, 0.0, 1.02), math.pi),
    WallTag(1, (1.75, WALL - _OFF_THE_WALL, 1.16), -math.pi / 2),
    WallTag(2, (-1.60, WALL - _OFF_THE_WALL, 1.16), -math.pi / 2),
    WallTag(3, (_BACK + _OFF_THE_WALL, 1.85, 1.16), 0.0),
    WallTag(4, (-1.60, -WALL + _OFF_THE_WALL, 1.16), math.pi / 2),
    WallTag(5, (1.75, -WALL + _OFF_THE_WALL, 1.16), math.pi / 2),
)
"""One before and one behind the one who acts, two at each side, over the furniture and under the pictures' middle."""


def bits(number: int) -> NDArray[np.bool_]:
    """The cells of a tag from the top left, white is true; the outermost ring is the white margin."""
    code = np.array([_CODES[number] >> k & 1 for k in reversed(range(36))], dtype=bool).reshape(6, 6)
    return np.pad(np.pad(code, 1, constant_values=False), 1, constant_values=True)


def make_tags(maker: Maker) -> None:
    """Hang the tags on the walls; they are scenery."""
    cell = SIZE / BORDER
    for tag in TAGS:
        turn = [math.cos(tag.facing / 2), 0, 0, math.sin(tag.facing / 2)]
        right = (-math.sin(tag.facing), math.cos(tag.facing))  # of one who looks at it
        half = CELLS * cell / 2
        maker.slab(f"room/tag{tag.number}", (0.004, half, half), tag.at, (0.96, 0.96, 0.96), quat=turn)
        for row, first, last in _black_runs(tag.number):
            across = ((first + last) / 2 + 0.5 - CELLS / 2) * cell
            at = (
                tag.at[0] + 0.003 * math.cos(tag.facing) + across * right[0],
                tag.at[1] + 0.003 * math.sin(tag.facing) + across * right[1],
                tag.at[2] + (CELLS / 2 - row - 0.5) * cell,
            )
            size = (0.003, (last - first + 1) * cell / 2, cell / 2)
            maker.slab(f"room/tag{tag.number}-{row}-{first}", size, at, (0.03, 0.03, 0.03), quat=turn)


def _black_runs(number: int) -> Iterator[tuple[int, int, int]]:
    """Row, first and last column of the black stripes of a tag."""
    for row, cells in enumerate(bits(number)):
        for white, last in np.flatnonzero(np.diff(cells)).reshape(-1, 2).tolist():
            yield row, white + 1, last
