"""What chooses the continuous parameters of a skill while a plan is executed (method 7)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pix2pred.structs.objects import Object

Features = Mapping[Object, tuple[float, ...]]
"""Object features in the order of their types' feature names."""


@dataclass(frozen=True, slots=True)
class Draw:
    """Parameters inside the skill's box, which sampler they come from, and how many draws it rejected before."""

    params: tuple[float, ...]
    sampler: str
    rejections: int = 0


class Sampler(Protocol):
    """Chooses parameters for one operator."""

    @property
    def name(self) -> str:
        """How it was made, e.g. ``gaussian``, ``torch`` or ``uniform``."""
        ...

    def sample(self, features: Features, objects: Sequence[Object], rng: np.random.Generator) -> Draw:
        """Parameters for the operator with its parameters bound, in order, to ``objects``."""
        ...


def clip_to_box(values: NDArray[np.float64], low: Sequence[float], high: Sequence[float]) -> tuple[float, ...]:
    """``values`` moved into the box; what is not a number becomes the middle of its side."""
    lower, upper = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    finite = np.where(np.isnan(values), (lower + upper) / 2, values)
    return tuple(float(v) for v in np.clip(finite, lower, upper))


@dataclass(frozen=True, slots=True)
class UniformSampler:
    """Any point of the box: what is done when nothing was learned."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    name: str = "uniform"

    def sample(self, features: Features, objects: Sequence[Object], rng: np.random.Generator) -> Draw:
        """A point drawn uniformly, whatever the state."""
        return Draw(tuple(float(v) for v in rng.uniform(self.low, self.high)), self.name)
