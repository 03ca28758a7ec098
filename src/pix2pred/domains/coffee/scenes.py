"""Random initial worlds (method 10.3): cups in the front, the jug behind them, turned away or not."""

from __future__ import annotations

import math

import numpy as np

from pix2pred.domains.coffee.simulation.geometry import CUP_CAPACITIES, CUP_RADIUS, HOME, TABLE_Z, Point
from pix2pred.domains.coffee.world import CoffeeWorld, Cup, Gripper, Jug
from pix2pred.domains.seeds import look

CUP_AREA = ((0.61, 1.0), (1.09, 1.27))
"""x and y of the middles of cups."""

JUG_AREA = ((0.58, 0.72), (1.39, 1.47))
CUP_GAP = 0.03
"""Least distance between two cups' sides."""

MOST_CUPS = 8

SIZED = 3
"""The second number of a sized task's seed; other domains use ``Split.SIZED``, and these tasks stay what they were."""


def initial_world(cups: int, rng: np.random.Generator, turned_away: bool | None = None) -> CoffeeWorld:
    """``cups`` empty cups of random sizes, an empty jug, the machine off, the gripper at rest.

    ``turned_away`` says whether the jug's handle is out of reach; by default it is for half of the scenes. Raises
    ``ValueError`` for more cups than fit on the table.
    """
    if not 0 <= cups <= MOST_CUPS:
        raise ValueError(f"{cups} cups: between 0 and {MOST_CUPS} fit on the table")
    away = bool(rng.random() < 0.5) if turned_away is None else turned_away
    jug = Jug(random_place(JUG_AREA, rng), rot=random_rotation(away, rng))
    sizes = [float(c) for c in rng.choice(CUP_CAPACITIES, size=cups)]
    places = cup_places(sizes, rng)
    made = tuple(Cup(f"cup{i}", x, y, c) for i, (c, (x, y)) in enumerate(zip(sizes, places, strict=True)))
    return CoffeeWorld(Gripper(HOME), jug, made, look=look(rng))


def random_rotation(away: bool, rng: np.random.Generator) -> float:
    """An angle of the jug: between 50 and 120 degrees to either side, or within the reach of the gripper."""
    if not away:
        return float(rng.uniform(-0.09, 0.09))
    return float(rng.uniform(math.radians(50), math.radians(120)) * rng.choice((-1, 1)))


def random_place(area: tuple[tuple[float, float], tuple[float, float]], rng: np.random.Generator) -> Point:
    """A place on the table inside ``area``."""
    (x0, x1), (y0, y1) = area
    return Point(float(rng.uniform(x0, x1)), float(rng.uniform(y0, y1)), TABLE_Z)


def cup_places(sizes: list[float], rng: np.random.Generator) -> list[tuple[float, float]]:
    """Random places for cups of ``sizes``, far enough apart; starts over whenever the next cup finds no place."""
    while True:
        places: list[tuple[float, float]] = []
        for i, size in enumerate(sizes):
            for _ in range(40):
                spot = random_place(CUP_AREA, rng)
                gaps = (
                    math.hypot(spot.x - x, spot.y - y) - CUP_RADIUS[size] - CUP_RADIUS[sizes[j]]
                    for j, (x, y) in enumerate(places)
                )
                if all(gap >= CUP_GAP for gap in gaps):
                    places.append((spot.x, spot.y))
                    break
            if len(places) == i:
                break
        if len(places) == len(sizes):
            return places
