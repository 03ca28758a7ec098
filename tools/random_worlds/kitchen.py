"""Kitchens of any arrangement, for training and judging the offline reader: what skills leave behind, good or bad."""

from __future__ import annotations

import numpy as np

from pix2pred.domains.kitchen.arm import JOINTS
from pix2pred.domains.kitchen.environment import HORIZON, KitchenEnvironment
from pix2pred.domains.kitchen.scenes import KETTLE_PUSH, LEFT, PUSH_ANGLE, RIGHT, push_kettle, turn_on
from pix2pred.domains.kitchen.world import KitchenWorld, standing_world
from pix2pred.domains.seeds import Split, scene_generator

_FINISHED = 0.7
_TURNS = 0.4
_SPREAD = (0.05, 0.03, 0.08, 0.2)
_BURNERS = ((0.221, 0.339), (-0.225, 0.339), (0.219, 0.78), (-0.222, 0.78))
"""Centres of the four burners (metres)."""


def random_worlds(seed: int, looks: int, per_look: int) -> list[KitchenWorld]:
    """``looks`` groups of ``per_look`` scenes, apart from demonstrations and tasks.

    A group holds what a skill with random parameters leaves behind, stopped anywhere on its way in 30 % of the cases,
    and copies of it with knobs and kettle put elsewhere.
    """
    worlds: list[KitchenWorld] = []
    for rng in scene_generator(seed, Split.READER).spawn(looks):
        first = _left_behind(rng)
        worlds.append(first)
        worlds.extend(_rearranged(rng, first) for _ in range(per_look - 1))
    return worlds


def _left_behind(rng: np.random.Generator) -> KitchenWorld:
    """The kitchen after a skill with random parameters, or somewhere on its way."""
    start = standing_world(*_kettle_place(rng), _knobs(rng))
    number = str(int(rng.integers(1, 5)))
    if rng.random() < _TURNS:
        action = turn_on(number, PUSH_ANGLE + float(rng.normal(0, 0.3)))
    else:
        action = push_kettle(number, tuple(float(v) for v in np.array(KETTLE_PUSH) + rng.normal(0, _SPREAD)))
    commands = HORIZON if rng.random() < _FINISHED else int(rng.integers(20, 350))
    environment = KitchenEnvironment(start, (), commands)
    environment.execute(action)
    return environment.world


def _rearranged(rng: np.random.Generator, world: KitchenWorld) -> KitchenWorld:
    """``world`` with the arm where it is, and knobs and a standing kettle put elsewhere."""
    other = standing_world(*_kettle_place(rng), _knobs(rng))
    return KitchenWorld(world.positions[:JOINTS] + other.positions[JOINTS:])


def _kettle_place(rng: np.random.Generator) -> tuple[float, float]:
    """In front, near a burner, or anywhere on the stove (metres)."""
    kind = rng.random()
    if kind < 0.35:
        return (LEFT, RIGHT)[rng.integers(2)] + float(rng.normal(0, 0.03)), float(rng.uniform(0.35, 0.6))
    if kind < 0.75:
        x, y = _BURNERS[rng.integers(4)]
        return x + float(rng.normal(0, 0.08)), y + float(rng.normal(0, 0.08))
    return float(rng.uniform(-0.35, 0.35)), float(rng.uniform(0.3, 0.8))


def _knobs(rng: np.random.Generator) -> tuple[float, float, float, float]:
    """More than half of the knobs off, few of them turned a little, the others clearly on."""
    angles = np.where(rng.random(4) < 0.45, rng.uniform(-1.4, -0.3, 4), 0.0)
    a, b, c, d = np.where(rng.random(4) < 0.1, rng.uniform(-0.2, 0, 4), angles)
    return float(a), float(b), float(c), float(d)
