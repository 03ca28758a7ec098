"""The random generators of scenes: every scene has one of its own, apart from all others of its domain."""

from __future__ import annotations

from enum import IntEnum

import numpy as np


class Split(IntEnum):
    """The second number of a seed: what the scene is for."""

    DEMONSTRATIONS = 0
    TASKS = 1
    READER = 2
    DISTURBANCES = 3
    SIZED = 4


def look(rng: np.random.Generator) -> int:
    """The seed of how a scene or a thing in it is drawn."""
    return int(rng.integers(2**31))


def scene_generator(seed: int, split: int, *numbers: int) -> np.random.Generator:
    """The generator of one scene, seeded by ``(seed, split, *numbers)``.

    ``numbers`` are mostly those of the family and of the demonstration or task.
    """
    return np.random.default_rng(np.random.SeedSequence((seed, int(split), *numbers)))
