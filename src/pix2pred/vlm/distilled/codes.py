"""Short codes of what was seen: principal components of each part, and how much of a part they leave out.

What they leave out tells a new look from a known one: pixels unlike all that was seen lie far from the components.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pix2pred.vlm.distilled.sight import Array, split


@dataclass(frozen=True, slots=True)
class PartCode:
    """Components of one part of what is seen, of shape (components, numbers of the part).

    ``spread`` is the deviation of each component, ``residual`` the largest usual distance from all of them, measured on
    demonstrations that were left out.
    """

    mean: Array
    components: Array
    spread: Array
    residual: float

    def codes(self, part: Array) -> Array:
        """Codes of parts of shape (n, numbers): (n, components)."""
        found: Array = ((part - self.mean) @ self.components.T).astype(np.float32)
        return found

    def strangeness(self, part: Array, codes: Array) -> Array:
        """How far parts lie from the components, in units of what is usual: (n,)."""
        left: Array = np.linalg.norm(part - self.mean - codes @ self.components, axis=1).astype(np.float32)
        left /= np.float32(self.residual)
        return left


@dataclass(frozen=True, slots=True)
class Coded:
    """Codes of n boxes, part by part, and how strange each box looks (1 is the most that is usual)."""

    parts: Mapping[str, Array]
    strange: Array


@dataclass(frozen=True, slots=True)
class RegionCode:
    """The codes of one kind of region: objects of a type, or the part of the picture that two objects share."""

    parts: Mapping[str, PartCode]

    def __call__(self, vectors: Array) -> Coded:
        """Codes of seen vectors of shape (n, LENGTH)."""
        codes: dict[str, Array] = {}
        strange = np.zeros(len(vectors), dtype=np.float32)
        for name, part in split(vectors).items():
            code = self.parts[name]
            found = code.codes(part)
            strange = np.maximum(strange, code.strangeness(part, found))
            codes[name] = (found / code.spread).astype(np.float32)
        return Coded(codes, strange)
