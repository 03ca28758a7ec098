"""Where cleanup scenes start: tables with scribbles, bins, an eraser and other things where physics lets them lie."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pix2pred.domains.cleanup.skills import all_strokes
from pix2pred.domains.home.drawing.fixtures import bin_size, table_size
from pix2pred.domains.home.places import Place, apart
from pix2pred.domains.home.settling import free_spot, rise_of, settled
from pix2pred.domains.home.world import Body, Quaternion, Thing, Vector, World
from pix2pred.domains.seeds import look

Rng = np.random.Generator

DEMONSTRATED_KINDS = ("ball", "block", "bottle", "book", "car")
"""Things in demonstrations and, with other looks, in tests with a new background."""

NEW_KINDS = ("banana", "can", "carton", "duck", "tape")
"""Things in tests alone."""

TABLE, SECOND_TABLE, NARROW, WIDE, OTHER = "desk", "bench", "narrow_bin", "wide_bin", "other_bin"
FLOOR = "floor"
_FLOOR_AREA = ((0.42, 0.70), (-0.22, 0.22))
_GAP = 0.15


@dataclass(frozen=True, slots=True)
class CleanupScene:
    """What a scene holds: the place (``floor``, a table or a bin) of every small thing, whose name is its kind.

    ``kinds`` of things that are not called by their kind; ``closed`` bins; one or two ``tables``, ``scribbled`` or
    not; ``gaze`` is looked at first.
    """

    things: Mapping[str, str]
    bins: Sequence[str] = (NARROW, WIDE)
    closed: Sequence[str] = ()
    tables: int = 1
    scribbled: bool = True
    gaze: str = ""
    kinds: Mapping[str, str] = field(default_factory=dict)


def make_world(plan: CleanupScene, body: Body, style: str, rng: Rng) -> World:
    """The world of ``plan`` at rest, everything else drawn from ``rng``."""
    side = 1 if rng.random() < 0.5 else -1
    strokes = all_strokes() if plan.scribbled else ()
    middles, spread = ((0.0,), 0.06) if plan.tables == 1 else ((0.47, -0.47), 0.02)
    tables = [
        Thing(name, "table", "table", look(rng), (_near(rng, 1.13, 0.03), _near(rng, y, spread), 0), strokes=strokes)
        for name, y in zip((TABLE, SECOND_TABLE), middles, strict=False)
    ]
    places = {
        NARROW: (_near(rng, 0.54, 0.02), side * _near(rng, 0.45, 0.02), 0.0),
        WIDE: (_near(rng, 0.56, 0.03), -side * _near(rng, 0.60, 0.03), 0.0),
        OTHER: (_near(rng, 0.50, 0.02), side * _near(rng, 0.78, 0.02), 0.0),
    }
    bins = [
        Thing(
            name,
            "trash_can",
            WIDE if name == WIDE else NARROW,
            look(rng),
            places[name],
            opened=name not in plan.closed,
        )
        for name in plan.bins
    ]
    things = [Thing(n, "movable_object", plan.kinds.get(n, n), look(rng)) for n in plan.things]
    world = World((*tables, *bins, *things), body, look(rng), style, plan.gaze)
    return arranged(world, plan.things, rng)


def arranged(world: World, places: Mapping[str, str], rng: Rng) -> World:
    """``world`` with its small things put to their places and at rest."""
    taken: dict[str, list[Place]] = {}
    lifted = [replace(world.thing(n), at=(3.0 * i, 50.0, 0.0)) for i, n in enumerate(places)]
    posed = world.with_thing(*lifted)
    for name, place in places.items():
        thing = world.thing(name)
        at = _spot(posed, place, taken.setdefault(place, []), thing, rng)
        posed = posed.with_thing(replace(thing, at=at, turn=_turned(rng)))
    return settled(posed, 1.5)


def _spot(world: World, place: str, taken: list[Place], thing: Thing, rng: Rng) -> Vector:
    rise = rise_of(thing) + 0.01
    if place == FLOOR:
        x, y = _apart(_FLOOR_AREA, taken, rng)
        return x, y, rise
    under = world.thing(place)
    if under.type == "table":
        size, (cx, cy, _) = table_size(under), under.at
        hx, hy = size.half_x - 0.08, size.half_y - 0.09
        x, y = _apart(((cx - hx, cx + hx), (cy - hy, cy + hy)), taken, rng)
        return x, y, size.height + rise
    x, y = free_spot(world, under)
    height = 0.02 + rise + 0.13 * len(taken)
    taken.append((x, y))
    return x, y, min(height, bin_size(under).height + 0.05)


def _apart(area: tuple[Place, Place], taken: list[Place], rng: Rng) -> Place:
    """A place in ``area`` far from those taken: the best of many."""
    (x0, x1), (y0, y1) = area
    return apart(rng.uniform((x0, y0), (x1, y1), size=(30, 2)), taken, _GAP)


def _turned(rng: Rng) -> Quaternion:
    half = float(rng.uniform(-math.pi, math.pi)) / 2
    return math.cos(half), 0.0, 0.0, math.sin(half)


def _near(rng: Rng, middle: float, spread: float) -> float:
    return float(rng.uniform(middle - spread, middle + spread))
