"""A room drawn from a seed: floor, walls, window, furniture along the walls, and light."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pix2pred.domains.home.drawing.textures import SURFACES
from pix2pred.domains.physics import Maker

Rng = np.random.Generator
Colour = tuple[float, float, float]

WALL = 3.0
"""Distance of the walls from the origin, in metres; the one behind the one who acts is further away."""

HEIGHT = 2.7


@dataclass(frozen=True, slots=True)
class Style:
    """What the rooms of one style are made of."""

    floors: Sequence[tuple[str, Colour]]
    walls: Sequence[tuple[str, Colour]]
    furniture: Sequence[Colour]


@dataclass(frozen=True, slots=True)
class Lamps:
    """How bright both lamps are, and the light from everywhere and from ahead; half angle of the cones, and fading."""

    first: tuple[float, float]
    second: tuple[float, float]
    everywhere: tuple[float, float]
    ahead: float
    cone: float
    fading: float


SPOTS = Lamps((0.42, 0.58), (0.12, 0.25), (0.36, 0.46), 0.28, 45.0, 10.0)
EVEN = Lamps((0.32, 0.44), (0.10, 0.18), (0.36, 0.44), 0.20, 85.0, 1.5)
"""Spots would paint a white patch on a counter, on which clear and white cups could not be told from it."""

STYLES: Mapping[str, Style] = {
    "home": Style(
        (("planks", (0.62, 0.45, 0.30)), ("planks", (0.78, 0.62, 0.44)), ("carpet", (0.62, 0.60, 0.56)),
         ("carpet", (0.42, 0.47, 0.55)), ("tiles", (0.80, 0.77, 0.70))),
        (("plaster", (0.88, 0.86, 0.80)), ("plaster", (0.76, 0.83, 0.84)), ("stripes", (0.84, 0.80, 0.70)),
         ("plaster", (0.85, 0.78, 0.72))),
        ((0.45, 0.30, 0.20), (0.72, 0.70, 0.66), (0.30, 0.36, 0.42)),
    ),
    "office": Style(
        (("tiles", (0.62, 0.65, 0.68)), ("carpet", (0.36, 0.40, 0.38)), ("stone", (0.72, 0.70, 0.68)),
         ("planks", (0.46, 0.36, 0.30))),
        (("plaster", (0.93, 0.93, 0.92)), ("bricks", (0.62, 0.36, 0.28)), ("plaster", (0.62, 0.72, 0.66)),
         ("plaster", (0.70, 0.72, 0.82))),
        ((0.80, 0.80, 0.82), (0.22, 0.24, 0.28), (0.56, 0.42, 0.28)),
    ),
    "studio": Style(
        (("stone", (0.55, 0.50, 0.46)), ("tiles", (0.40, 0.46, 0.48)), ("planks", (0.70, 0.66, 0.60)),
         ("carpet", (0.55, 0.38, 0.36))),
        (("bricks", (0.72, 0.62, 0.54)), ("stripes", (0.62, 0.70, 0.76)), ("plaster", (0.82, 0.72, 0.52)),
         ("plaster", (0.55, 0.60, 0.62))),
        ((0.62, 0.30, 0.22), (0.25, 0.38, 0.32), (0.78, 0.74, 0.62)),
    ),
}  # fmt: skip
"""Demonstrations are made at ``home``, tests in the ``office``, tests with a new background in the ``studio``."""


def _between(rng: Rng, low: float, high: float) -> float:
    return float(rng.uniform(low, high))


def furnish(maker: Maker, seed: int, style: str, lamps: Lamps) -> None:
    """Add the room of ``seed`` to the scene: everything in it is scenery and belongs to no object."""
    rng = np.random.default_rng(np.random.SeedSequence((seed, 11)))
    chosen = STYLES[style]
    name, colour = chosen.floors[int(rng.integers(len(chosen.floors)))]
    maker.texture("floor", SURFACES[name](_tinted(colour, rng), rng), _between(rng, 0.9, 1.5))
    name, colour = chosen.walls[int(rng.integers(len(chosen.walls)))]
    maker.texture("wall", SURFACES[name](_tinted(colour, rng), rng), _between(rng, 0.6, 1.0))
    maker.slab("room/floor", (WALL + 1, WALL + 1, 0.05), (0, 0, -0.05), material="floor", solid=True)
    for x, y, half_x, half_y in (
        (WALL, 0, 0.05, 4),
        (-WALL - 0.8, 0, 0.05, 4),
        (0, WALL, 4, 0.05),
        (0, -WALL, 4, 0.05),
    ):
        maker.slab(f"room/wall{x:g}{y:g}", (half_x, half_y, HEIGHT / 2), (x, y, HEIGHT / 2), material="wall")
        skirting = (half_x + 0.015, half_y + 0.015, 0.05)
        maker.slab(f"room/skirting{x:g}{y:g}", skirting, (x, y, 0.05), (0.9, 0.9, 0.88))
    _window(maker, rng)
    _along_the_walls(maker, rng, chosen)
    _light(maker, rng, lamps)


def _tinted(colour: Colour, rng: Rng) -> np.ndarray:
    return np.clip(np.array(colour) + rng.uniform(-0.05, 0.05, 3), 0.05, 1)


def _window(maker: Maker, rng: Rng) -> None:
    y = _between(rng, -1.6, 1.6)
    sky = (0.72, 0.85, 0.97)
    maker.slab("room/window", (0.01, 0.55, 0.42), (WALL - 0.06, y, 1.75), sky, glow=0.8)
    for k, (dy, dz, hy, hz) in enumerate(((0, 0.44, 0.6, 0.03), (0, -0.44, 0.6, 0.03), (0, 0, 0.02, 0.42),
                                          (0.57, 0, 0.03, 0.46), (-0.57, 0, 0.03, 0.46))):  # fmt: skip
        maker.slab(f"room/frame{k}", (0.02, hy, hz), (WALL - 0.07, y + dy, 1.75 + dz), (0.95, 0.95, 0.95))


def _along_the_walls(maker: Maker, rng: Rng, style: Style) -> None:
    """A cupboard or shelf at the far wall, a sofa or a chest at the sides and behind, pictures, a plant."""
    colours = [_tinted(c, rng) for c in style.furniture]

    def colour() -> Sequence[float]:
        return tuple(colours[int(rng.integers(len(colours)))])

    side = 1 if rng.random() < 0.5 else -1
    _shelf(maker, rng, (WALL - 0.25, side * _between(rng, 1.4, 2.1)), colour())
    _chest(
        maker,
        "room/chest",
        (WALL - 0.28, -side * _between(rng, 1.2, 2.0)),
        (0.2, 0.5, _between(rng, 0.3, 0.5)),
        colour(),
    )
    for k, sign in enumerate((1, -1)):
        x = _between(rng, -0.8, 1.2)
        if rng.random() < 0.5:
            _sofa(maker, f"room/sofa{k}", (x, sign * (WALL - 0.5)), sign, colour())
        else:
            _chest(maker, f"room/side{k}", (x, sign * (WALL - 0.3)), (0.5, 0.2, _between(rng, 0.35, 0.8)), colour())
        art = tuple(rng.uniform(0.2, 0.9, 3))
        maker.slab(f"room/art{k}", (0.3, 0.01, 0.22), (x, sign * (WALL - 0.07), 1.7), art)
        maker.slab(f"room/artframe{k}", (0.33, 0.008, 0.25), (x, sign * (WALL - 0.062), 1.7), (0.2, 0.17, 0.15))
    _plant(maker, rng, (WALL - 0.4, side * 0.55))
    _chest(maker, "room/behind", (-WALL - 0.4, _between(rng, -1, 1)), (0.2, 0.6, _between(rng, 0.3, 0.7)), colour())


def _chest(maker: Maker, name: str, place: tuple[float, float], half: Sequence[float], colour: Sequence[float]) -> None:
    x, y = place
    maker.slab(name, half, (x, y, half[2]), colour)
    lighter = tuple(min(1.0, c * 1.15 + 0.03) for c in colour)
    maker.slab(f"{name}top", (half[0] + 0.015, half[1] + 0.015, 0.015), (x, y, 2 * half[2]), lighter)


def _shelf(maker: Maker, rng: Rng, place: tuple[float, float], colour: Sequence[float]) -> None:
    x, y = place
    for k, dy in enumerate((-0.45, 0.45)):
        maker.slab(f"room/shelfside{k}", (0.15, 0.02, 0.8), (x, y + dy, 0.8), colour)
    for k in range(4):
        z = 0.1 + 0.48 * k
        maker.slab(f"room/board{k}", (0.15, 0.45, 0.015), (x, y, z), colour)
        if k < 3:
            at = -0.4
            for b in range(int(rng.integers(3, 7))):
                wide, high = _between(rng, 0.015, 0.035), _between(rng, 0.09, 0.17)
                at += 2 * wide + 0.004
                cover = tuple(rng.uniform(0.1, 0.85, 3))
                maker.slab(f"room/book{k}{b}", (0.09, wide, high), (x, y + at, z + 0.015 + high), cover)


def _sofa(maker: Maker, name: str, place: tuple[float, float], sign: int, colour: Sequence[float]) -> None:
    x, y = place
    darker = tuple(c * 0.85 for c in colour)
    maker.slab(name, (0.8, 0.35, 0.2), (x, y, 0.22), colour)
    maker.slab(f"{name}back", (0.8, 0.1, 0.25), (x, y + sign * 0.32, 0.6), darker)
    for k, dx in enumerate((-0.75, 0.75)):
        maker.slab(f"{name}arm{k}", (0.09, 0.38, 0.14), (x + dx, y, 0.52), darker)


def _plant(maker: Maker, rng: Rng, place: tuple[float, float]) -> None:
    x, y = place
    maker.drum("room/pot", 0.14, 0.13, (x, y, 0.13), (0.75, 0.42, 0.3))
    for k in range(7):
        angle, out = 2 * math.pi * k / 7, _between(rng, 0.05, 0.16)
        green = (0.15, _between(rng, 0.35, 0.55), 0.18)
        at = (x + out * math.cos(angle), y + out * math.sin(angle), _between(rng, 0.4, 0.75))
        maker.egg(f"room/leaf{k}", (0.08, 0.08, 0.17), at, green)


def _light(maker: Maker, rng: Rng, lamps: Lamps) -> None:
    warm = _between(rng, -0.04, 0.06)
    strength = _between(rng, *lamps.first)
    place = (_between(rng, -0.6, 1.6), _between(rng, -1.2, 1.2), 2.6)
    maker.light(place, (strength + warm, strength, strength - warm), lamps.cone, lamps.fading)
    other = _between(rng, *lamps.second)
    side = (_between(rng, -1.5, 0), _between(rng, -2, 2), 2.4)
    maker.light(side, (other, other, other), lamps.cone, lamps.fading)
    maker.ambient(_between(rng, *lamps.everywhere), lamps.ahead)
