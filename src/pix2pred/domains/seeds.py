"""The random generators of scenes: every scene has one of its own, apart from all others of its domain."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from typing import TypeVar

import numpy as np

World = TypeVar("World")


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


def worlds_of_looks(
    random_world: Callable[[np.random.Generator, int], World], seed: int, looks: int, per_look: int
) -> list[World]:
    """``per_look`` random worlds in each of ``looks`` looks, apart from demonstrations and tasks."""
    rng = scene_generator(seed, Split.READER)
    return [random_world(rng, one) for one in (look(rng) for _ in range(looks)) for _ in range(per_look)]
