"""A kernel machine: a score for every word about objects of the same kinds, from rows that were seen in training.

The kernel is a mixture of a linear one, in which every part of the codes counts by its variance, and a Gaussian one, in
which every component counts alike. Rows of training serve all words; each word has its own weights.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pix2pred.vlm.distilled.sight import Array


@dataclass(frozen=True, slots=True)
class Kernel:
    """``linear`` in [0, 1] is the share of the linear kernel; ``scale`` the squared length of the Gaussian one.

    ``parts`` are the parts of the codes that count.
    """

    linear: float
    scale: float
    parts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the parts of a code lie, and by what a part's components are multiplied in the linear kernel."""

    places: Mapping[str, tuple[int, int]]
    spreads: Array

    def columns(self, parts: Sequence[str]) -> list[int]:
        """The columns of ``parts``."""
        return [i for part in parts for i in range(*self.places[part])]

    def shares(self) -> Array:
        """One over the number of components of each column's part: parts count alike in the Gaussian kernel."""
        share = np.zeros(len(self.spreads), dtype=np.float32)
        for first, last in self.places.values():
            share[first:last] = 1 / max(1, last - first)
        return share


def gram(kernel: Kernel, layout: Layout, a: Array, b: Array) -> Array:
    """The kernel between rows of codes: (rows of a, rows of b). Spreads of a part are scaled to a variance of 1."""
    columns = layout.columns(kernel.parts)
    total = np.zeros((len(a), len(b)), dtype=np.float32)
    if kernel.linear:
        weight = layout.spreads[columns]
        total += np.float32(kernel.linear / len(kernel.parts)) * ((a[:, columns] * weight) @ (b[:, columns] * weight).T)
    if kernel.linear < 1:
        distance = squared_distances(layout, columns, a, b) / len(kernel.parts)
        total += np.float32(1 - kernel.linear) * np.exp(-distance / np.float32(kernel.scale))
    return total


def squared_distances(layout: Layout, columns: Sequence[int], a: Array, b: Array) -> Array:
    """Squared distances of codes in which every part counts alike: (rows of a, rows of b)."""
    weight = np.sqrt(layout.shares()[columns])
    x, y = a[:, columns] * weight, b[:, columns] * weight
    found: Array = np.maximum((x**2).sum(axis=1)[:, None] + (y**2).sum(axis=1)[None] - 2 * x @ y.T, 0)
    return found


@dataclass(frozen=True, slots=True)
class WordMachine:
    """What one word makes of the rows: its kernel, and a weight for every row."""

    kernel: Kernel
    weights: Array

    def scores(self, layout: Layout, codes: Array, rows: Array) -> Array:
        """Scores of codes of shape (n, columns): positive for true."""
        found: Array = gram(self.kernel, layout, codes, rows) @ self.weights
        return found
