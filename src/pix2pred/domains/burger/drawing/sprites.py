"""Sprites by kind of object, drawn once per scene and instance and kept."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import PIL.Image

from pix2pred.domains.burger.drawing import fixtures, food
from pix2pred.domains.burger.drawing.canvas import Canvas
from pix2pred.domains.burger.world import Heading

Painter = Callable[[Canvas, np.random.Generator, bool], None]

PAINTERS: Mapping[str, Painter] = {
    "patty": food.patty,
    "lettuce": food.lettuce,
    "cheese": food.cheese,
    "bottom_bun": food.bottom_bun,
    "top_bun": food.top_bun,
    "grill": fixtures.grill,
    "cutting_board": fixtures.cutting_board,
    "robot": fixtures.robot,
}

_QUARTER_TURNS = {Heading.RIGHT: 0, Heading.UP: 1, Heading.LEFT: 2, Heading.DOWN: 3}

SOLID = 96
"""Least opacity, of 255, that counts as part of an object when its box is measured."""


@dataclass(frozen=True, eq=False, slots=True)
class Sprite:
    """A drawing of an object on a transparent cell; ``box`` is (left, top, right, bottom) of its visible part."""

    image: PIL.Image.Image
    box: tuple[int, int, int, int]


@lru_cache(maxsize=1024)
def sprite(
    kind: str, name: str, look: int, *, prepared: bool = False, heading: Heading = Heading.RIGHT, scale: float = 1
) -> Sprite:
    """The sprite of the object ``name`` of type ``kind`` in the scene seeded by ``look``.

    The same name and look give the same drawing; ``scale`` is its size relative to a full cell.
    """
    canvas = _drawing(kind, name, look, prepared)
    image = canvas.finished(scale, _QUARTER_TURNS[heading])
    box = image.getchannel("A").point([255 if a >= SOLID else 0 for a in range(256)]).getbbox()
    assert box is not None, f"the painter of {kind} drew nothing"
    return Sprite(image, box)


@lru_cache(maxsize=64)
def _drawing(kind: str, name: str, look: int, prepared: bool) -> Canvas:
    canvas = Canvas()
    PAINTERS[kind](canvas, instance_generator(name, look), prepared)
    return canvas


def instance_generator(name: str, look: int) -> np.random.Generator:
    """The generator of one instance's look, seeded by (look, bytes of its name)."""
    return np.random.default_rng(np.random.SeedSequence((look, *name.encode())))
