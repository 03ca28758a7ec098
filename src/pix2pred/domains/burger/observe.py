"""What leaves the simulator: a picture, positions and given atoms, never hidden state (method 1.2)."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.domains.burger.classifiers import objects_of, true_atoms
from pix2pred.domains.burger.drawing.render import render
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.structs import Object, Predicate, State


def features_of(world: BurgerWorld) -> dict[Object, tuple[float, ...]]:
    """Row, column and level of everything; for the robot also ``fingers`` (1 while it holds) and ``dir``."""
    features: dict[Object, tuple[float, ...]] = {}
    for item in objects_of(world):
        if item.name == world.robot:
            fingers = 0.0 if world.held is None else 1.0
            place = (float(world.cell.row), float(world.cell.col), 0.0)
            features[item] = (*place, fingers, float(world.heading))
        else:
            thing = world.thing(item.name)
            features[item] = (float(thing.cell.row), float(thing.cell.col), float(thing.z))
    return features


def observe(world: BurgerWorld, predicates: Sequence[Predicate]) -> State:
    """The state seen in ``world``, with the true atoms of ``predicates``."""
    return State((render(world),), features_of(world), true_atoms(world, predicates))
