"""Where scenes start and what the demonstrator does (method 10.1)."""

from __future__ import annotations

import numpy as np

from pix2pred.domains.kitchen.vocabulary import KETTLE_BOILING, OBJECT_OF, PUSH_KETTLE, TURN_ON_KNOB
from pix2pred.domains.kitchen.world import KitchenWorld, standing_world
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Action, Atom

PUSH_ANGLE = np.pi / 9
"""The demonstrator's push at a knob."""

KETTLE_PUSH = (0.0, -0.2, -0.13, 0.0)
"""The demonstrator's push at the kettle: from 20 cm before it, 13 cm below its handle, straight away."""

LEFT, RIGHT = -0.269, 0.169
"""x of the kettle's start in demonstrations and in tests, in metres."""


def start_world(seed: int, split: Split, index: int, x: float) -> KitchenWorld:
    """The kettle stands at ``x``, 40 to 55 cm before the robot; seeded by ``(seed, split, index)``."""
    rng = scene_generator(seed, split, index)
    return standing_world(x, float(rng.uniform(0.4, 0.55)))


def boiling(number: str) -> tuple[Atom, ...]:
    """The goal that the kettle boils on burner ``number``."""
    return (KETTLE_BOILING(OBJECT_OF["kettle"], OBJECT_OF[f"burner{number}"], OBJECT_OF[f"knob{number}"]),)


def turn_on(number: str, angle: float = PUSH_ANGLE) -> Action:
    """Turn on knob ``number``."""
    return Action(TURN_ON_KNOB, (OBJECT_OF["gripper"], OBJECT_OF[f"knob{number}"]), (angle,))


def push_kettle(number: str, params: tuple[float, ...] = KETTLE_PUSH) -> Action:
    """Push the kettle onto burner ``number``."""
    return Action(PUSH_KETTLE, (OBJECT_OF["gripper"], OBJECT_OF["kettle"], OBJECT_OF[f"burner{number}"]), params)
