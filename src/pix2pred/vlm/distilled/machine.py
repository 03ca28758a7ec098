"""A kernel machine: a score for every word about objects of the same kinds, from rows that were seen in training.

The kernel is a mixture of a linear one, in which every part of the codes counts by its variance, and a Gaussian one, in
which every component counts alike. Rows of training serve all words; each word has its own weights.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from pix2pred.vlm.distilled.sight import Array

COMPANY = "company"
"""The part of the codes that tells what lies about an object."""


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

    @property
    def parts(self) -> tuple[str, ...]:
        """All parts."""
        return tuple(self.places)

    @property
    def own(self) -> tuple[str, ...]:
        """The parts that are about the objects themselves: new company makes nothing strange."""
        return tuple(part for part in self.places if part != COMPANY)

    def mean_of(self, parts: Sequence[str]) -> Array:
        """By column the weight with which ``parts`` count alike, and all components of one of them; 0 for others."""
        weight = np.zeros(len(self.spreads), dtype=np.float32)
        for part in parts:
            first, last = self.places[part]
            weight[first:last] = 1 / (max(1, last - first) * len(parts))
        return weight


@dataclass(frozen=True, slots=True)
class Rows:
    """Codes of shape (rows, columns) with which others are compared; what does not depend on the others is kept."""

    layout: Layout
    codes: Array
    _norms: dict[tuple[str, ...], Array] = field(default_factory=dict, compare=False)

    def norms(self, parts: tuple[str, ...]) -> Array:
        """Squared lengths in which ``parts`` count alike: (rows,)."""
        if parts not in self._norms:
            self._norms[parts] = self.codes**2 @ self.layout.mean_of(parts)
        return self._norms[parts]


@dataclass(frozen=True, slots=True)
class Compared:
    """Codes compared with rows; what several kernels need is computed once."""

    codes: Array
    rows: Rows
    _squared: dict[tuple[str, ...], Array] = field(default_factory=dict, compare=False)
    _products: dict[tuple[str, ...], Array] = field(default_factory=dict, compare=False)

    def squared(self, parts: tuple[str, ...]) -> Array:
        """Squared distances in which ``parts`` count alike: (codes, rows)."""
        if parts not in self._squared:
            weight = self.rows.layout.mean_of(parts)
            own = self.codes**2 @ weight
            products = (self.codes * weight) @ self.rows.codes.T
            self._squared[parts] = np.maximum(own[:, None] + self.rows.norms(parts)[None] - 2 * products, 0)
        return self._squared[parts]

    def gram(self, kernel: Kernel) -> Array:
        """The kernel: (codes, rows). Components of a part are scaled so that its variance is 1 in the linear one."""
        total = np.zeros((len(self.codes), len(self.rows.codes)), dtype=np.float32)
        if kernel.linear:
            total += np.float32(kernel.linear) * self._product(kernel.parts)
        if kernel.linear < 1:
            total += np.float32(1 - kernel.linear) * np.exp(self.squared(kernel.parts) / np.float32(-kernel.scale))
        return total

    def _product(self, parts: tuple[str, ...]) -> Array:
        if parts not in self._products:
            layout = self.rows.layout
            weight = np.where(layout.mean_of(parts) > 0, layout.spreads**2 / np.float32(len(parts)), 0)
            self._products[parts] = (self.codes * weight) @ self.rows.codes.T
        return self._products[parts]


@dataclass(frozen=True, slots=True)
class WordMachine:
    """What one word makes of the rows: its kernel, and a weight for every row. Scores are positive for true."""

    kernel: Kernel
    weights: Array

    def scores(self, compared: Compared) -> Array:
        """Scores of the codes that are compared with the rows."""
        found: Array = compared.gram(self.kernel) @ self.weights
        return found
