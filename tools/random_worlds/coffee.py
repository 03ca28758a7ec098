"""Worlds of any arrangement, for training and judging the offline reader.

The skills put gripper and jug where they end up in episodes; fill levels and lamp are then drawn anew, so that they
tell nothing about places and places tell nothing about them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pix2pred.domains.coffee.classifiers import AboveCup
from pix2pred.domains.coffee.demonstrator import actions_of
from pix2pred.domains.coffee.environment import CoffeeEnvironment
from pix2pred.domains.coffee.families import CoffeeRecipe
from pix2pred.domains.coffee.scenes import JUG_AREA, initial_world, random_place, random_rotation
from pix2pred.domains.coffee.simulation.geometry import (
    CLOSED,
    FULL_JUG,
    GRIP,
    HIGH,
    JUG_HEIGHT,
    LOW,
    OPEN,
    POUR_TILT,
    Point,
)
from pix2pred.domains.coffee.world import CoffeeWorld, Cup, Gripper
from random_worlds.looks import worlds_of_looks

MOST_CUPS = 6
_PERTURBED = 0.4
_TO_THE_END = 0.3


def random_world(rng: np.random.Generator, look: int) -> CoffeeWorld:
    """A scene of one to six cups somewhere in an episode, drawn in the look seeded by ``look``."""
    recipe = CoffeeRecipe(int(rng.integers(1, MOST_CUPS + 1)), bool(rng.random() < 0.5))
    start = replace(initial_world(recipe.cups, rng, recipe.turned_away), look=look)
    environment = CoffeeEnvironment(start, (), (), AboveCup.ANYWHERE)
    actions = actions_of(recipe, start)
    first_pour = len(actions) - recipe.cups
    pours = [actions[first_pour + i] for i in rng.permutation(recipe.cups)]
    script = [*actions[:first_pour], *pours[: int(rng.integers(1, 3))]]
    length = len(script) if rng.random() < _TO_THE_END else int(rng.integers(len(script) + 1))
    for action in script[:length]:
        environment.execute(action)
    world = environment.world
    if rng.random() < _PERTURBED:
        world = _perturbed(world, rng)
    return replace(
        world,
        machine_on=bool(rng.random() < 0.5),
        jug=replace(world.jug, level=_jug_level(rng)),
        cups=tuple(replace(c, current=_cup_level(c, rng)) for c in world.cups),
    )


def _jug_level(rng: np.random.Generator) -> float:
    """Empty, full, or anything between that can be told from both."""
    kind = rng.random()
    return 0.0 if kind < 0.3 else FULL_JUG if kind < 0.6 else float(rng.uniform(0.05, 0.92)) * FULL_JUG


def _cup_level(cup: Cup, rng: np.random.Generator) -> float:
    """Empty, filled, or now and then something between."""
    kind = rng.random()
    share = 0.0 if kind < 0.45 else rng.uniform(0.76, 1.0) if kind < 0.92 else rng.uniform(0.1, 0.6)
    return float(share) * cup.capacity


def _perturbed(world: CoffeeWorld, rng: np.random.Generator) -> CoffeeWorld:
    """The world with gripper or jug somewhere else."""
    somewhere = Point(*(float(rng.uniform(lo, hi)) for lo, hi in zip(LOW, HIGH, strict=True)))
    if world.jug.held:
        at = Point(float(rng.uniform(0.42, 0.8)), float(rng.uniform(1.1, 1.5)), float(rng.uniform(0.36, 0.5)))
        tilt = POUR_TILT if rng.random() < 0.5 else 0.0
        return replace(world, robot=Gripper(at, tilt, 0.0, CLOSED), jug=replace(world.jug, at=at - GRIP))
    if not world.jug_in_machine:
        place = random_place(JUG_AREA, rng)
        world = replace(world, jug=replace(world.jug, at=place, rot=random_rotation(bool(rng.random() < 0.5), rng)))
    jug = world.jug.at
    robots = (
        Gripper(somewhere),
        Gripper(jug + GRIP + Point(float(rng.uniform(-0.12, -0.06)), 0, float(rng.uniform(0, 0.05)))),
        Gripper(jug + Point(0, 0, JUG_HEIGHT + float(rng.uniform(0.02, 0.12))), tilt=1.57, fingers=OPEN),
    )
    return replace(world, robot=robots[int(rng.integers(2 if world.jug_in_machine else 3))])


def random_worlds(seed: int, looks: int, per_look: int) -> list[CoffeeWorld]:
    """``looks`` differently drawn scenes with ``per_look`` arrangements each, apart from demonstrations and tasks."""
    return worlds_of_looks(random_world, seed, looks, per_look)
