"""Small things that a hand can take: an eraser, toys, household things, fruit. Sizes in metres."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from pix2pred.domains.physics import Maker

Rng = np.random.Generator
Colour = tuple[float, ...]

BRIGHT: Sequence[Colour] = (
    (0.85, 0.16, 0.14), (0.12, 0.36, 0.80), (0.95, 0.75, 0.10), (0.14, 0.58, 0.25), (0.90, 0.45, 0.10),
    (0.55, 0.20, 0.60), (0.10, 0.62, 0.66),
)  # fmt: skip


BRIGHT_NAMES = ("red", "blue", "yellow", "green", "orange", "purple", "turquoise")
"""What a person calls them."""


@dataclass(frozen=True, slots=True)
class MovableKind:
    """How a kind of thing is made, how high its middle lies above what it rests on, and how far it reaches.

    ``shade`` is the share of its reach that its shadow has.
    """

    make: Callable[[Maker, Any, str, Rng], None]
    rise: float
    radius: float
    shade: float = 0.9


def bright_number(rng: Rng) -> int:
    """Which of the bright colours a toy has; the first thing that is drawn from its look."""
    return int(rng.integers(len(BRIGHT)))


def bright(rng: Rng) -> Colour:
    """A toy's colour."""
    colour = np.array(BRIGHT[bright_number(rng)]) + rng.uniform(-0.05, 0.05, 3)
    return tuple(float(c) for c in np.clip(colour, 0, 1))


def _dark(colour: Colour, share: float = 0.6) -> Colour:
    return tuple(share * c for c in colour)


def _eraser(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    back = ((0.16, 0.30, 0.62), (0.70, 0.14, 0.16), (0.10, 0.10, 0.12), (0.16, 0.42, 0.30))[int(rng.integers(4))]
    maker.slab(f"{name}/felt", (0.075, 0.034, 0.014), (0, 0, -0.012), (0.30, 0.30, 0.32), body=body, solid=True)
    maker.slab(f"{name}/seam", (0.076, 0.035, 0.003), (0, 0, 0.004), (0.85, 0.84, 0.80), body=body)
    maker.slab(f"{name}/back", (0.075, 0.034, 0.011), (0, 0, 0.016), back, body=body, solid=True)
    maker.slab(f"{name}/label", (0.045, 0.018, 0.001), (0, 0, 0.0275), (0.95, 0.95, 0.93), body=body)


def _ball(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    colour = bright(rng)
    maker.ball(f"{name}/ball", 0.05, (0, 0, 0), colour, body=body, solid=True)
    maker.drum(f"{name}/band", 0.0506, 0.007, (0, 0, 0), (0.96, 0.96, 0.94), body=body)


def _block(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    maker.slab(f"{name}/cube", (0.042, 0.042, 0.042), (0, 0, 0), colour := bright(rng), body=body, solid=True)
    pale = tuple(0.5 + 0.5 * c for c in colour)
    for k, (half, at) in enumerate(
        (((0.028, 0.028, 0.001), (0, 0, 0.042)), ((0.028, 0.001, 0.028), (0, -0.042, 0)),
         ((0.001, 0.028, 0.028), (-0.042, 0, 0)), ((0.028, 0.001, 0.028), (0, 0.042, 0)))
    ):  # fmt: skip
        maker.slab(f"{name}/face{k}", half, at, pale, body=body)


def _car(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    colour = bright(rng)
    maker.slab(f"{name}/base", (0.07, 0.034, 0.016), (0, 0, -0.004), colour, body=body, solid=True)
    maker.slab(f"{name}/cabin", (0.036, 0.030, 0.017), (-0.008, 0, 0.028), (0.75, 0.88, 0.95), body=body, solid=True)
    maker.slab(f"{name}/roof", (0.037, 0.031, 0.004), (-0.008, 0, 0.046), colour, body=body)
    for k, (x, y) in enumerate(((0.042, 0.036), (0.042, -0.036), (-0.042, 0.036), (-0.042, -0.036))):
        maker.drum(f"{name}/wheel{k}", 0.02, 0.007, (x, y, -0.018), (0.08, 0.08, 0.08), body=body, solid=True,
                   quat=[0.7071, 0.7071, 0, 0])  # fmt: skip
        maker.drum(
            f"{name}/hub{k}", 0.009, 0.0075, (x, y, -0.018), (0.8, 0.8, 0.8), body=body, quat=[0.7071, 0.7071, 0, 0]
        )


def _bottle(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    colour = ((0.16, 0.45, 0.30), (0.45, 0.28, 0.12), (0.30, 0.62, 0.80))[int(rng.integers(3))]
    maker.drum(f"{name}/belly", 0.034, 0.05, (0, 0, -0.025), colour, body=body, solid=True)
    maker.egg(f"{name}/shoulder", (0.034, 0.034, 0.025), (0, 0, 0.025), colour, body=body)
    maker.drum(f"{name}/neck", 0.013, 0.022, (0, 0, 0.055), colour, body=body, solid=True)
    maker.drum(f"{name}/cap", 0.015, 0.007, (0, 0, 0.077), bright(rng), body=body)
    maker.drum(f"{name}/label", 0.0345, 0.022, (0, 0, -0.025), (0.95, 0.93, 0.86), body=body)


def _book(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    colour = bright(rng)
    maker.slab(f"{name}/pages", (0.064, 0.048, 0.011), (0.002, 0, 0), (0.95, 0.93, 0.86), body=body, solid=True)
    for k, z in enumerate((-0.0125, 0.0125)):
        maker.slab(f"{name}/cover{k}", (0.069, 0.052, 0.002), (0, 0, z), colour, body=body)
    maker.slab(f"{name}/spine", (0.002, 0.052, 0.0145), (-0.069, 0, 0), _dark(colour), body=body)
    maker.slab(f"{name}/title", (0.03, 0.026, 0.0005), (0.01, 0, 0.0148), (0.97, 0.92, 0.7), body=body)


def _duck(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    yellow = (0.97, 0.82, 0.12)
    maker.egg(f"{name}/belly", (0.055, 0.042, 0.036), (0, 0, -0.012), yellow, body=body, solid=True)
    maker.ball(f"{name}/head", 0.027, (0.036, 0, 0.038), yellow, body=body, solid=True)
    maker.egg(f"{name}/beak", (0.015, 0.013, 0.006), (0.066, 0, 0.034), (0.95, 0.45, 0.1), body=body)
    maker.egg(f"{name}/tail", (0.02, 0.02, 0.014), (-0.052, 0, 0.008), yellow, body=body)
    for k, y in enumerate((0.016, -0.016)):
        maker.ball(f"{name}/eye{k}", 0.005, (0.055, y, 0.048), (0.05, 0.05, 0.05), body=body)


def _can(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    maker.drum(f"{name}/can", 0.034, 0.055, (0, 0, 0), colour := bright(rng), body=body, solid=True)
    for k, z in enumerate((-0.054, 0.054)):
        maker.drum(f"{name}/rim{k}", 0.031, 0.004, (0, 0, z), (0.78, 0.79, 0.80), body=body)
    maker.drum(f"{name}/band", 0.0345, 0.016, (0, 0, 0.005), _dark((1.0, 1.0, 1.0), 0.95), body=body)
    maker.drum(f"{name}/stripe", 0.0348, 0.005, (0, 0, 0.005), _dark(colour), body=body)


def _carton(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    colour = bright(rng)
    maker.slab(f"{name}/box", (0.035, 0.035, 0.055), (0, 0, 0), (0.95, 0.95, 0.93), body=body, solid=True)
    maker.slab(f"{name}/band", (0.0355, 0.0355, 0.028), (0, 0, -0.012), colour, body=body)
    maker.slab(f"{name}/roof", (0.024, 0.035, 0.010), (0, 0, 0.062), (0.92, 0.92, 0.9), body=body)
    maker.drum(f"{name}/cap", 0.012, 0.006, (0.0, 0.0, 0.076), colour, body=body)


def _banana(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    points = [(0.075 * math.sin(a), 0.10 * math.cos(a) - 0.085) for a in np.linspace(-1.1, 1.1, 6)]
    for k, ((ax, ay), (bx, by)) in enumerate(pairwise(points)):
        thick = 0.017 if 0 < k < 4 else 0.013
        maker.rod(f"{name}/part{k}", thick, (ax, ay, 0), (bx, by, 0), (0.96, 0.83, 0.2), body=body, solid=True)
    maker.ball(f"{name}/end0", 0.008, (points[0][0] - 0.004, points[0][1] - 0.008, 0), (0.25, 0.2, 0.1), body=body)
    maker.ball(f"{name}/end1", 0.009, (points[-1][0] + 0.004, points[-1][1] - 0.008, 0), (0.4, 0.42, 0.15), body=body)


def _tape(maker: Maker, body: Any, name: str, rng: Rng) -> None:
    maker.drum(f"{name}/roll", 0.05, 0.02, (0, 0, 0), bright(rng), body=body, solid=True)
    maker.drum(f"{name}/core", 0.027, 0.0206, (0, 0, 0), (0.72, 0.58, 0.42), body=body)
    maker.drum(f"{name}/hole", 0.022, 0.021, (0, 0, 0), (0.16, 0.14, 0.12), body=body)


def fruit(
    colour: Colour, half: Sequence[float], stem: Colour, *, leaf: bool = False, tips: bool = False
) -> Callable[[Maker, Any, str, Rng], None]:
    """A fruit, with a leaf at its stem or with pointed ends. What squeezing leaves of it is drawn by ``rind``."""

    def make(maker: Maker, body: Any, name: str, rng: Rng) -> None:
        shade = tuple(float(c) for c in np.clip(np.array(colour) + rng.uniform(-0.03, 0.03, 3), 0, 1))
        maker.egg(f"{name}/flesh", half, (0, 0, 0), shade, body=body, solid=True)
        maker.egg(
            f"{name}/shine",
            [0.3 * h for h in half],
            (-0.5 * half[0], 0, 0.72 * half[2]),
            tuple(0.6 + 0.4 * c for c in shade),
            body=body,
        )
        maker.drum(f"{name}/stem", 0.004, 0.010, (0, 0, half[2] + 0.002), stem, body=body)
        if leaf:
            at = (0.014, -0.012, half[2] + 0.007)
            maker.egg(f"{name}/leaf", (0.020, 0.009, 0.002), at, (0.20, 0.46, 0.14), body=body)
        for k, end in enumerate((1, -1) if tips else ()):
            maker.egg(f"{name}/tip{k}", (0.013, 0.011, 0.011), (end * half[0] * 0.98, 0, 0), shade, body=body)

    return make


FRUIT_COLOUR: Mapping[str, Colour] = {
    "orange": (0.96, 0.52, 0.08), "apple": (0.78, 0.10, 0.12), "lime": (0.36, 0.66, 0.14), "plum": (0.36, 0.12, 0.42),
    "lemon": (0.97, 0.87, 0.22),
}  # fmt: skip
_BROWN: Colour = (0.30, 0.22, 0.10)

KINDS: Mapping[str, MovableKind] = {
    "eraser": MovableKind(_eraser, 0.027, 0.08),
    "ball": MovableKind(_ball, 0.05, 0.05),
    "block": MovableKind(_block, 0.042, 0.055),
    "car": MovableKind(_car, 0.038, 0.075),
    "bottle": MovableKind(_bottle, 0.075, 0.05),
    "book": MovableKind(_book, 0.0145, 0.08),
    "duck": MovableKind(_duck, 0.048, 0.07),
    "can": MovableKind(_can, 0.055, 0.045),
    "carton": MovableKind(_carton, 0.055, 0.05),
    "banana": MovableKind(_banana, 0.017, 0.085),
    "tape": MovableKind(_tape, 0.02, 0.05),
    "orange": MovableKind(
        fruit(FRUIT_COLOUR["orange"], (0.042, 0.042, 0.040), (0.25, 0.4, 0.12), leaf=True), 0.04, 0.045, 0.72
    ),
    "apple": MovableKind(fruit(FRUIT_COLOUR["apple"], (0.042, 0.042, 0.038), _BROWN, leaf=True), 0.038, 0.045, 0.72),
    "lime": MovableKind(fruit(FRUIT_COLOUR["lime"], (0.040, 0.034, 0.034), _BROWN, tips=True), 0.034, 0.042, 0.72),
    "plum": MovableKind(fruit(FRUIT_COLOUR["plum"], (0.036, 0.036, 0.038), _BROWN), 0.038, 0.04, 0.72),
    "lemon": MovableKind(fruit(FRUIT_COLOUR["lemon"], (0.048, 0.034, 0.034), _BROWN, tips=True), 0.034, 0.05, 0.72),
    "melon": MovableKind(fruit((0.42, 0.62, 0.30), (0.11, 0.11, 0.105), _BROWN), 0.105, 0.12, 0.72),
}
"""``melon`` goes into no juicer."""
