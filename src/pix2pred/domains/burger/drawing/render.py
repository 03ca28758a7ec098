"""A picture of a world without any text, and the box of every object in it.

Stacked items are shifted up by ``LEVEL`` pixels per level and drawn from the lowest to the highest, so that each shows
a strip of its lower side. A held item is drawn small in the robot's gripper, above everything else. A box is amodal:
it covers the whole drawing of the object, also where something hides it, cut at the edge of the picture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import PIL.Image
import PIL.ImageDraw
import PIL.ImageFilter

from pix2pred.domains.burger.drawing.canvas import UNITS
from pix2pred.domains.burger.drawing.floor import floor
from pix2pred.domains.burger.drawing.sprites import Sprite, sprite
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.structs import Box, Image, Picture, Pixels

CAMERA = "top"
LEVEL = 19
"""Upward shift per level of a stack, in pixels (0.15 cell)."""

HELD_SCALE = 0.54
"""Size of a held item's cell; the item itself is then about 0.35 cell wide."""

_REACH = 40


@dataclass(frozen=True, slots=True)
class _Placed:
    name: str
    sprite: Sprite
    left: int
    top: int
    shadow: bool

    def box(self, side: int) -> Box:
        """The box of the drawing in a picture of ``side`` pixels."""
        left, top, right, bottom = self.sprite.box
        edges = (self.left + left, self.top + top, self.left + right, self.top + bottom)
        return Box(*(float(max(0, min(side, edge))) for edge in edges))


def render(world: BurgerWorld) -> Picture:
    """The picture of ``world``, 128 pixels a cell, with the boxes of all its objects."""
    placed = _layout(world)
    boxes = {p.name: p.box(UNITS * world.size) for p in sorted(placed, key=lambda p: p.name)}
    return Picture(CAMERA, Image.from_pixels(_draw(world, placed)), boxes)


def render_pixels(world: BurgerWorld) -> Pixels:
    """The pixels of the picture alone."""
    return _draw(world, _layout(world))


def _draw(world: BurgerWorld, placed: list[_Placed]) -> Pixels:
    image = floor(world.look, world.size).copy()
    for p in placed:
        if p.shadow:
            image.paste((24, 16, 10), (p.left, p.top), _SHADOW)
        image.paste(p.sprite.image, (p.left, p.top), p.sprite.image)
    return np.asarray(image, dtype=np.uint8)


def _layout(world: BurgerWorld) -> list[_Placed]:
    """Everything in drawing order: row by row from the back, each stack upwards, the held item last."""
    body = sprite("robot", world.robot, world.look, heading=world.heading)
    entries = [((world.cell.row, 0), _Placed(world.robot, body, world.cell.col * UNITS, world.cell.row * UNITS, True))]
    for thing in world.things:
        if thing.name != world.held:
            drawing = sprite(thing.type, thing.name, world.look, prepared=thing.prepared)
            top = thing.cell.row * UNITS - _rise(thing.cell.row, thing.z)
            entries.append(
                ((thing.cell.row, thing.z), _Placed(thing.name, drawing, thing.cell.col * UNITS, top, thing.z == 0))
            )
    ordered = [p for _, p in sorted(entries, key=lambda e: (e[0], e[1].name))]
    return ordered if world.held is None else [*ordered, _in_gripper(world, world.held)]


def _rise(row: int, z: int) -> int:
    """Pixels that level ``z`` lies higher than the floor; levels beyond the upper edge of the picture pile up there."""
    return min(z * LEVEL, row * UNITS + UNITS - 52)


def _in_gripper(world: BurgerWorld, held: str) -> _Placed:
    thing = world.thing(held)
    drawing = sprite(thing.type, thing.name, world.look, prepared=thing.prepared, scale=HELD_SCALE)
    left, top, right, bottom = drawing.box
    cell, ahead = world.cell, world.cell.toward(world.heading)
    x = (cell.col + 0.5) * UNITS + _REACH * (ahead.col - cell.col)
    y = (cell.row + 0.5) * UNITS + _REACH * (ahead.row - cell.row)
    return _Placed(held, drawing, round(x - (left + right) / 2), round(y - (top + bottom) / 2), False)


def _make_shadow() -> PIL.Image.Image:
    mask = PIL.Image.new("L", (UNITS, UNITS + 12), 0)
    PIL.ImageDraw.Draw(mask).ellipse([14, 92, UNITS - 6, UNITS - 2], 105)
    return mask.filter(PIL.ImageFilter.GaussianBlur(5))


_SHADOW = _make_shadow()
