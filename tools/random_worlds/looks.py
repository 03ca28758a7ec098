"""Random worlds in groups that are drawn alike."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from pix2pred.domains.seeds import Split, look, scene_generator

World = TypeVar("World")


def worlds_of_looks(
    random_world: Callable[[np.random.Generator, int], World], seed: int, looks: int, per_look: int
) -> list[World]:
    """``per_look`` random worlds in each of ``looks`` looks, apart from demonstrations and tasks."""
    rng = scene_generator(seed, Split.READER)
    return [random_world(rng, one) for one in (look(rng) for _ in range(looks)) for _ in range(per_look)]
