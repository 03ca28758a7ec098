"""The example that a new project begins with: two cups and a box, drawn, so that every verb has something to read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import PIL.Image
import PIL.ImageDraw

from pix2pred.demos.authoring.declaring import Declarations, declare
from pix2pred.demos.authoring.drafts import Draft
from pix2pred.demos.authoring.photos import MAIN
from pix2pred.structs import Image

_TYPES = ("hand", "cup", "box")
_OBJECTS = ("hand:hand = hand", "red_cup:cup = red cup", "blue_cup:cup = blue cup", "box:box = box")
_SKILLS = ("Open(hand, box)", "PutIn(hand, cup, box)", "Close(hand, box)")
_PREDICATES = ("In(cup, box) = skills: +PutIn(1, 2)", "Closed(box) = vlm: closed")

_SIZE = (480, 360)
_TABLE, _WOOD, _INSIDE, _EDGE = (222, 214, 200), (150, 104, 62), (84, 56, 34), (60, 40, 24)
_COLORS = {"red_cup": (190, 50, 45), "blue_cup": (50, 85, 170)}


@dataclass(frozen=True, slots=True)
class _Table:
    """What is drawn: the cups that are in the box, and whether its lid is open."""

    inside: tuple[str, ...] = ()
    is_open: bool = False


def example_declarations() -> Declarations:
    """Types, objects, skills and initial predicates of the example."""
    return declare(_TYPES, _OBJECTS, _SKILLS, _PREDICATES)


def example_drafts() -> tuple[Draft, ...]:
    """Two demonstrations: one cup goes into the box, then both do."""
    return (_demo("one-cup", ("red_cup",)), _demo("two-cups", ("blue_cup", "red_cup")))


def _demo(name: str, cups: tuple[str, ...]) -> Draft:
    puts = tuple(f"PutIn(hand, {cup}, box)" for cup in cups)
    actions = ("Open(hand, box)", *puts, "Close(hand, box)")
    goal = (*(f"In({cup}, box)" for cup in cups), "Closed(box)")
    note = "An example to replace: the pictures are drawings. Copy this folder, or remove it, when you have your own."
    return Draft(name, actions, tuple(_states(cups)), goal=goal, notes=(note,))


def _states(cups: tuple[str, ...]) -> Iterator[Mapping[str, Image]]:
    table = _Table()
    yield _drawn(table)
    table = replace(table, is_open=True)
    yield _drawn(table)
    for cup in cups:
        table = replace(table, inside=(*table.inside, cup))
        yield _drawn(table)
    yield _drawn(replace(table, is_open=False))


def _drawn(table: _Table) -> Mapping[str, Image]:
    """A picture of the table from the front."""
    page = PIL.Image.new("RGB", _SIZE, (238, 240, 242))
    draw = PIL.ImageDraw.Draw(page)
    draw.rectangle((0, 250, *_SIZE), _TABLE)
    box = (250, 170, 440, 290)
    if table.is_open:
        draw.polygon([(250, 170), (440, 170), (456, 96), (266, 96)], _WOOD, _EDGE, 3)
        draw.polygon([(250, 170), (440, 170), (424, 150), (266, 150)], _INSIDE, _EDGE, 3)
        for i, cup in enumerate(sorted(table.inside)):
            _cup(draw, 280 + 75 * i, 118, _COLORS[cup])
    draw.rectangle(box, _WOOD, _EDGE, 3)
    if not table.is_open:
        draw.rectangle((242, 150, 448, 176), _WOOD, _EDGE, 3)
    for i, cup in enumerate(sorted(_COLORS)):
        if cup not in table.inside:
            _cup(draw, 40 + 95 * i, 232, _COLORS[cup])
    return {MAIN: Image.from_pixels(np.asarray(page, dtype=np.uint8))}


def _cup(draw: PIL.ImageDraw.ImageDraw, left: int, top: int, color: tuple[int, int, int]) -> None:
    draw.arc((left + 42, top + 12, left + 72, top + 46), -90, 90, color, 7)
    draw.polygon([(left, top), (left + 56, top), (left + 48, top + 62), (left + 8, top + 62)], color, _EDGE, 2)
