"""Cups and bowls with visible contents, and the juicer. A vessel's place is the middle of its foot."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pix2pred.domains.home.drawing.movables import BRIGHT_NAMES, FRUIT_COLOUR, bright, bright_number
from pix2pred.domains.home.world import Thing
from pix2pred.domains.physics import Maker

Colour = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Vessel:
    """Outer radius at foot and rim, height, opacity, and whether it counts as a cup and as plastic."""

    foot: float
    rim: float
    height: float
    alpha: float
    cup: bool
    plastic: bool


VESSELS: Mapping[str, Vessel] = {
    "plastic_cup": Vessel(0.043, 0.060, 0.125, 1.0, True, True),
    "tumbler": Vessel(0.046, 0.055, 0.135, 0.45, True, True),
    "glass": Vessel(0.044, 0.050, 0.145, 0.28, True, False),
    "mug": Vessel(0.052, 0.054, 0.11, 1.0, True, False),
    "bowl": Vessel(0.060, 0.110, 0.075, 1.0, False, False),
}
"""``plastic_cup`` is bright with a white rim band, ``tumbler`` tinted, ``glass`` clear, ``mug`` has a handle."""

DRINKS: Mapping[str, Colour] = {
    "coffee": (0.20, 0.11, 0.06), "cola": (0.30, 0.10, 0.05), "tea": (0.58, 0.28, 0.06), "pulp": (0.42, 0.40, 0.12),
}  # fmt: skip
"""What cups hold besides juice; ``pulp`` leaves the juicer by its waste valve."""


MOST_LIQUIDS = 3
"""Liquids in one vessel that are drawn: thick juices that were squeezed one after the other lie in rings."""


def liquid_colours(contents: Sequence[str]) -> list[Colour]:
    """The colours of the liquids in a vessel, from its wall inwards; juice is named after its fruit."""
    return [DRINKS.get(c) or FRUIT_COLOUR[c] for c in contents[:MOST_LIQUIDS]]


@dataclass(frozen=True, slots=True)
class NamedColour:
    """A colour and what a person calls it; a clear glass has none."""

    name: str
    colour: Colour


_MUGS = (
    NamedColour("white", (0.93, 0.92, 0.88)), NamedColour("dark grey", (0.30, 0.36, 0.42)),
    NamedColour("pale green", (0.62, 0.72, 0.66)), NamedColour("beige", (0.80, 0.70, 0.60)),
)  # fmt: skip
_BOWLS = (
    NamedColour("white", (0.94, 0.94, 0.92)), NamedColour("pale blue", (0.55, 0.66, 0.76)),
    NamedColour("beige", (0.80, 0.72, 0.60)),
)  # fmt: skip


def vessel_colour(thing: Thing) -> NamedColour:
    """The colour of a vessel's outside."""
    rng = np.random.default_rng(thing.look)
    name = BRIGHT_NAMES[bright_number(np.random.default_rng(thing.look))]
    colour = bright(rng)
    if thing.kind == "glass":
        return NamedColour("", (0.86, 0.93, 0.97))
    if thing.kind == "tumbler":
        return NamedColour(name, tuple(0.2 + 0.8 * c for c in colour))
    own = {"mug": _MUGS, "bowl": _BOWLS}.get(thing.kind)
    return own[int(rng.integers(len(own)))] if own else NamedColour(name, colour)


def make_vessel(maker: Maker, body: Any, thing: Thing) -> None:
    """A turned wall, and a column of liquid that is sized later."""
    v = VESSELS[thing.kind]
    name = thing.name
    colour = vessel_colour(thing).colour
    wall = 0.003
    maker.drum(f"{name}/liquid", 0.01, 0.01, (0, 0, 0.02), (0.5, 0.5, 0.5), body=body)
    for k in range(MOST_LIQUIDS):
        maker.drum(f"{name}/surface{k}", 0.01, 0.001, (0, 0, 0.02), (0.5, 0.5, 0.5), body=body)
    maker.turned(
        f"{name}-wall",
        [(0, 0), (v.foot, 0), (v.rim, v.height), (v.rim - wall, v.height), (v.foot - wall, wall), (0, wall)],
    )
    maker.shape(f"{name}/wall", f"{name}-wall", colour, body=body, alpha=v.alpha)
    rim_colour = (0.97, 0.97, 0.95) if thing.kind in ("plastic_cup", "bowl") else tuple(0.85 * c for c in colour)
    maker.turned(f"{name}-rim", [(v.rim - wall, v.height - 0.006), (v.rim + 0.002, v.height - 0.006),
                                 (v.rim + 0.002, v.height + 0.001), (v.rim - wall, v.height + 0.001)])  # fmt: skip
    maker.shape(f"{name}/rim", f"{name}-rim", rim_colour, body=body, alpha=min(1.0, 2 * v.alpha))
    if v.alpha == 1:
        low, high = v.foot - wall, v.rim - wall
        lining = [
            (low, 0.004),
            (high, v.height - 0.003),
            (high - 0.002, v.height - 0.003),
            (low - 0.002, 0.006),
            (0, 0.006),
        ]
        maker.turned(f"{name}-lining", lining)
        maker.shape(f"{name}/lining", f"{name}-lining", (0.86, 0.86, 0.85), body=body)
        maker.drum(f"{name}/bottom", low - 0.003, 0.0002, (0, 0, 0.0064), (0.60, 0.60, 0.60), body=body)
    if v.plastic:
        for k in range(3):
            z = (0.3 + 0.16 * k) * v.height
            r = v.foot + (v.rim - v.foot) * z / v.height + 0.0008
            maker.turned(
                f"{name}-rib{k}", [(r, z - 0.003), (r + 0.001, z - 0.003), (r + 0.001, z + 0.003), (r, z + 0.003)]
            )
            maker.shape(f"{name}/rib{k}", f"{name}-rib{k}", tuple(0.7 * c for c in colour), body=body, alpha=v.alpha)
    if thing.kind == "mug":
        x = -v.rim
        for k, z in enumerate((0.030, 0.082)):
            maker.rod(f"{name}/handle{k}", 0.008, (x, 0, z), (x - 0.036, 0, z), colour, body=body)
        maker.rod(f"{name}/grip", 0.008, (x - 0.036, 0, 0.030), (x - 0.036, 0, 0.082), colour, body=body)


@dataclass(frozen=True, slots=True)
class Level:
    """What shows of a liquid: a column that is no wider than the foot, and a disc as its surface."""

    radius: float
    height: float
    surface: float


BOTTOM = 0.007
"""Height of a vessel's inside bottom."""


def level(kind: str, amount: float) -> Level:
    """How a vessel filled to the share ``amount`` looks."""
    v = VESSELS[kind]
    height = max(1e-4, (v.height - 0.016) * amount)
    surface = v.foot + (v.rim - v.foot) * (BOTTOM + height) / v.height - 0.006
    return Level(v.foot - 0.006, height, surface)


WASTE_SIDE, JUICE_SIDE = 0.23, -0.23
"""Where the middles of the two marked regions are, to the left of the juicer's middle (metres)."""

REGION_FRONT = -0.05
"""How far the regions lie from the juicer's middle, towards the one who acts (negative: nearer)."""

REGION_HALF = 0.085
HOPPER_RADIUS, HOPPER_BOTTOM, HOPPER_TOP = 0.085, 0.24, 0.335
RIND_PLACE = (-0.22, 0.0)
"""Where squeezed fruit lies: on the tray before the juicer."""

JUICE_MARK, WASTE_MARK = (0.95, 0.55, 0.05), (0.08, 0.40, 0.75)


def make_juicer(maker: Maker, body: Any, thing: Thing) -> None:
    """A motor block with a panel, a clear hopper with a lid, two spouts over two regions taped on the table."""
    rng = np.random.default_rng(thing.look)
    name = thing.name
    shell = ((0.75, 0.76, 0.78), (0.24, 0.25, 0.28), (0.62, 0.14, 0.14), (0.90, 0.88, 0.84))[int(rng.integers(4))]
    dark = (0.10, 0.10, 0.12)
    maker.slab(f"{name}/foot", (0.10, 0.11, 0.012), (0, 0, 0.012), dark, body=body)
    maker.slab(f"{name}/block", (0.085, 0.095, 0.10), (0, 0, 0.125), shell, body=body)
    maker.slab(f"{name}/panel", (0.003, 0.06, 0.045), (-0.087, 0, 0.12), dark, body=body)
    maker.slab(f"{name}/lamp", (0.003, 0.045, 0.022), (-0.089, 0, 0.13), (0.2, 0.9, 0.35), body=body, glow=0.9)
    maker.drum(
        f"{name}/switch", 0.012, 0.006, (-0.092, 0, 0.09), (0.85, 0.85, 0.85), body=body, quat=[0.7071, 0, 0.7071, 0]
    )
    for side, y in (("waste", WASTE_SIDE), ("juice", JUICE_SIDE)):
        sign = 1 if y > 0 else -1
        maker.rod(
            f"{name}/{side}pipe",
            0.016,
            (REGION_FRONT / 2, sign * 0.09, 0.205),
            (REGION_FRONT, y, 0.25),
            dark,
            body=body,
        )
        maker.drum(f"{name}/{side}spout", 0.014, 0.02, (REGION_FRONT, y, 0.232), dark, body=body)
    maker.drum(f"{name}/collar", HOPPER_RADIUS + 0.006, 0.012, (0, 0, HOPPER_BOTTOM - 0.004), dark, body=body)
    inner = HOPPER_RADIUS - 0.003
    wall = [(HOPPER_RADIUS, HOPPER_BOTTOM), (HOPPER_RADIUS, HOPPER_TOP), (inner, HOPPER_TOP), (inner, HOPPER_BOTTOM)]
    maker.turned(f"{name}-glass", wall)
    maker.drum(f"room/{name}-floor", inner, 0.008, (0, 0, HOPPER_BOTTOM), dark, body=body, solid=True)
    for k in range(8):
        a = math.pi * k / 4
        at = ((inner + 0.008) * math.cos(a), (inner + 0.008) * math.sin(a), (HOPPER_BOTTOM + HOPPER_TOP) / 2 + 0.04)
        maker.slab(f"room/{name}-guard{k}", (0.006, 0.035, 0.10), at, body=body, solid=True, alpha=0,
                   quat=[math.cos(a / 2), 0, 0, math.sin(a / 2)])  # fmt: skip
    lid = maker.body(f"{name}-lid")
    maker.drum(f"{name}/lid", HOPPER_RADIUS + 0.004, 0.01, (-HOPPER_RADIUS, 0, 0.0), shell, body=lid)
    maker.drum(f"{name}/lidknob", 0.022, 0.014, (-HOPPER_RADIUS, 0, 0.02), dark, body=lid)
    maker.drum(
        f"{name}/lidinside", HOPPER_RADIUS - 0.01, 0.004, (-HOPPER_RADIUS, 0, -0.011), (0.85, 0.30, 0.12), body=lid
    )
    maker.shape(f"{name}/glass", f"{name}-glass", (0.75, 0.88, 0.92), body=body, alpha=0.22)
    tray = (0.86, 0.86, 0.88)
    maker.slab(f"room/tray-{name}", (0.055, 0.12, 0.004), (RIND_PLACE[0], 0, 0.004), tray, body=body)


def make_regions(maker: Maker, body: Any, thing: Thing) -> None:
    """Tape around the two regions, and a bar of the same colour in front of each; scenery, not part of the juicer."""
    for side, y, colour in (("waste", WASTE_SIDE, WASTE_MARK), ("juice", JUICE_SIDE, JUICE_MARK)):
        h = REGION_HALF
        for k, (half, at) in enumerate((((h, 0.008), (0, h)), ((h, 0.008), (0, -h)), ((0.008, h + 0.008), (h, 0)),
                                        ((0.016, h + 0.008), (-h, 0)))):  # fmt: skip
            at3 = (REGION_FRONT + at[0], y + at[1], 0.0008)
            maker.slab(f"room/{thing.name}-{side}{k}", (half[0], half[1], 0.0008), at3, colour, body=body)
