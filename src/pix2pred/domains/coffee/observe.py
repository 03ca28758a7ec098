"""What leaves the simulator: a picture, places and given atoms, never hidden state (method 1.2)."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.domains.coffee.classifiers import AboveCup, objects_of, true_atoms
from pix2pred.domains.coffee.simulation.geometry import TABLE_Z
from pix2pred.domains.coffee.simulation.render import render
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.structs import Object, Predicate, State


def features_of(world: CoffeeWorld) -> dict[Object, tuple[float, ...]]:
    """Heights, angles and the cups' places, in metres and radians. The rest is in the pictures alone."""
    robot, jug = world.robot, world.jug
    values: dict[str, tuple[float, ...]] = {
        "robot": (robot.at.z, robot.tilt, robot.wrist, robot.fingers),
        "jug": (jug.at.z, jug.rot, float(jug.held)),
        "coffee_machine": (),
    }
    features: dict[Object, tuple[float, ...]] = {}
    for item in objects_of(world):
        if item.type.name == "cup":
            cup = world.cup(item.name)
            features[item] = (cup.x, cup.y, TABLE_Z, cup.capacity)
        else:
            features[item] = values[item.type.name]
    return features


def observe(world: CoffeeWorld, predicates: Sequence[Predicate], above: AboveCup) -> State:
    """The state seen in ``world``, with the true atoms of ``predicates``."""
    return State((render(world),), features_of(world), true_atoms(world, predicates, above))
