"""Tables with marker scribbles, and bins. Sizes in metres; a fixture's place is the middle of its foot."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from pix2pred.domains.home.drawing.textures import SURFACES
from pix2pred.domains.home.world import Thing
from pix2pred.domains.physics import Maker

STROKES = 5
"""Scribbles on a table that nobody has wiped."""

_SEGMENTS = 9
_WALL = 0.006
_SMOOTH: Mapping[str, Any] = {"priority": 1, "friction": [0.25, 0.005, 0.001]}
"""Walls of bins decide how things slide along them."""


@dataclass(frozen=True, slots=True)
class Extent:
    """Half sizes of the top of a table or the inside of a bin, and how high it is."""

    half_x: float
    half_y: float
    height: float

    def is_under(self, at: Sequence[float], middle: Sequence[float], margin: float = 0.0) -> bool:
        """Whether ``at`` is over it, or beside it by no more than ``margin``, where its own middle is at ``middle``."""
        dx, dy = abs(at[0] - middle[0]), abs(at[1] - middle[1])
        return bool(dx <= self.half_x + margin and dy <= self.half_y + margin)


_SIZES = {
    "counter": Extent(0.36, 0.66, 0.62),
    "buffet": Extent(0.51, 1.08, 0.42),
    "banquet": Extent(0.65, 1.08, 0.42),
}
TOPS = ("table", *_SIZES)
"""Kinds of things that have a top to put something on."""


def table_size(thing: Thing) -> Extent:
    """The size of a table: a low one to clean, a counter, or a buffet for many."""
    if thing.kind in _SIZES:
        return _SIZES[thing.kind]
    rng = np.random.default_rng(thing.look)
    return Extent(float(rng.uniform(0.27, 0.32)), float(rng.uniform(0.36, 0.44)), float(rng.uniform(0.44, 0.52)))


_BINS = {"narrow_bin": Extent(0.12, 0.12, 0.32), "wide_bin": Extent(0.24, 0.18, 0.20)}


def bin_size(thing: Thing) -> Extent:
    """The inside of a bin."""
    return _BINS[thing.kind]


def make_table(maker: Maker, body: Any, thing: Thing) -> None:
    """A top of wood, white board or glass-like stone on four legs."""
    rng = np.random.default_rng(thing.look)
    size = table_size(thing)
    kind, colour = (
        ("planks", (0.80, 0.66, 0.48)), ("plaster", (0.92, 0.92, 0.90)), ("stone", (0.82, 0.80, 0.76)),
        ("planks", (0.88, 0.80, 0.66)),
    )[int(rng.integers(4))]  # fmt: skip
    maker.texture(f"{thing.name}-top", SURFACES[kind](np.array(colour), rng), 0.7)
    top = (size.half_x, size.half_y, 0.015)
    maker.slab(
        f"{thing.name}/top", top, (0, 0, size.height - 0.015), body=body, material=f"{thing.name}-top", solid=True
    )
    frame = tuple(0.72 * c for c in colour)
    rim = (size.half_x - 0.01, size.half_y - 0.01, 0.025)
    maker.slab(f"{thing.name}/frame", rim, (0, 0, size.height - 0.055), frame, body=body)
    leg = (size.height - 0.03) / 2
    for k, (sx, sy) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        at = (sx * (size.half_x - 0.035), sy * (size.half_y - 0.035), leg)
        maker.slab(f"{thing.name}/leg{k}", (0.022, 0.022, leg), at, frame, body=body)


def stroke_points(thing: Thing, number: int) -> list[tuple[float, float]]:
    """The course of a scribble on the table's top, relative to its middle."""
    size = table_size(thing)
    rng = np.random.default_rng(np.random.SeedSequence((thing.look, 5, number)))
    columns = 3
    row, column = divmod(number, columns)
    cx = (-0.45 + 0.9 * row) * size.half_x + float(rng.uniform(-0.03, 0.03))
    cy = (-0.62 + 0.62 * column) * size.half_y + float(rng.uniform(-0.04, 0.04))
    if row == 1:
        cy += 0.3 * size.half_y
    wide, high, turns = float(rng.uniform(0.09, 0.13)), float(rng.uniform(0.06, 0.09)), float(rng.uniform(1.2, 2.2))
    phase = float(rng.uniform(0, 2 * math.pi))
    points = []
    for k in range(_SEGMENTS + 1):
        t = k / _SEGMENTS
        x = cx + high * math.sin(2 * math.pi * turns * t + phase)
        y = cy + wide * (2 * t - 1)
        limit_x, limit_y = size.half_x - 0.03, size.half_y - 0.03
        points.append((min(max(x, -limit_x), limit_x), min(max(y, -limit_y), limit_y)))
    return points


def make_strokes(maker: Maker, body: Any, thing: Thing) -> None:
    """Scribbles by markers of several colours; those wiped off are made invisible later."""
    height = table_size(thing).height
    rng = np.random.default_rng(np.random.SeedSequence((thing.look, 6)))
    colours = ((0.08, 0.10, 0.14), (0.10, 0.22, 0.75), (0.80, 0.08, 0.12), (0.05, 0.45, 0.18))
    for number in range(STROKES):
        colour = colours[int(rng.integers(len(colours)))]
        points = stroke_points(thing, number)
        for k, ((ax, ay), (bx, by)) in enumerate(pairwise(points)):
            long = math.hypot(bx - ax, by - ay) / 2
            angle = math.atan2(by - ay, bx - ax) / 2
            maker.slab(
                f"{thing.name}/stroke{number}-{k}", (long + 0.006, 0.011, 0.0008),
                ((ax + bx) / 2, (ay + by) / 2, height + 0.0008), colour, body=body,
                quat=[math.cos(angle), 0, 0, math.sin(angle)],
            )  # fmt: skip


def make_bin(maker: Maker, body: Any, thing: Thing) -> None:
    """A bin with solid walls: a thing inside a narrow one is seen only from above. A lid lies on a closed one."""
    rng = np.random.default_rng(thing.look)
    size = bin_size(thing)
    x, y, h = size.half_x, size.half_y, size.height
    choices: Sequence[tuple[float, float, float]] = (
        ((0.42, 0.45, 0.48), (0.20, 0.36, 0.55), (0.70, 0.70, 0.72), (0.30, 0.42, 0.30))
        if thing.kind == "narrow_bin"
        else ((0.78, 0.60, 0.38), (0.86, 0.84, 0.78), (0.55, 0.35, 0.30), (0.40, 0.58, 0.62))
    )
    colour = choices[int(rng.integers(4))]
    inside = tuple(0.78 * c for c in colour)
    name = thing.name
    maker.slab(f"{name}/bottom", (x + _WALL, y + _WALL, 0.008), (0, 0, 0.008), inside, body=body, solid=True, **_SMOOTH)
    for k, (half, at) in enumerate(
        (((_WALL, y + 2 * _WALL, h / 2), (x + _WALL, 0, h / 2)),
         ((_WALL, y + 2 * _WALL, h / 2), (-x - _WALL, 0, h / 2)),
         ((x, _WALL, h / 2), (0, y + _WALL, h / 2)), ((x, _WALL, h / 2), (0, -y - _WALL, h / 2)))
    ):  # fmt: skip
        maker.slab(f"{name}/wall{k}", half, at, colour, body=body, solid=True, **_SMOOTH)
        wide = [v + (0.006 if v <= 2 * _WALL else 0.004) for v in half[:2]]
        maker.slab(f"{name}/rim{k}", (*wide, 0.008), (at[0], at[1], h - 0.006), (0.15, 0.15, 0.16), body=body)
        if thing.kind == "wide_bin":
            for b, z in enumerate((0.06, 0.12)):
                band = [v + (0.0015 if v <= 2 * _WALL else 0.0) for v in half[:2]]
                maker.slab(f"{name}/band{k}{b}", (*band, 0.007), (at[0], at[1], z), inside, body=body)
    if not thing.opened:
        maker.slab(f"{name}/lid", (x + 0.02, y + 0.02, 0.012), (0, 0, h + 0.012), inside, body=body, solid=True)
        maker.drum(f"{name}/knob", 0.025, 0.02, (0, 0, h + 0.035), (0.15, 0.15, 0.16), body=body)
