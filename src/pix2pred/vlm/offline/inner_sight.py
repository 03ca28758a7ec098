"""A sight for readers that tell what is in a vessel: every object's box stretched to one size, and like colours.

A square crop shows the opening of a tall cup and of a flat bowl at different places; in the stretched box of a vessel
seen from above it is always in the upper half. Everything is computed from the picture, its boxes and the types of the
objects that the prompt lists.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from pix2pred.structs import Box
from pix2pred.vlm.offline.fine_sight import FineScene
from pix2pred.vlm.offline.pixels import Vector

STRETCHED_SIDE = 24
"""Pixels that a box is stretched to."""

_MARGIN = 0.06
"""What of the surroundings is seen at every side of the box, as a share of its size."""

_OPENING, _BELOW, _MIDDLE = np.s_[2:12, 5:19], np.s_[13:23, 3:21], np.s_[3:11, 7:17]
"""Rows and columns of a stretched vessel: its opening, its wall, and the middle of the opening."""

_LIKE = (0.06, 0.10, 0.15, 0.22)
_SHARES = (0.05, 0.2, 0.4, 0.6)
_FARTHEST = 0.8
"""Distances of colours that count as like, shares of pixels whose distance is looked at, and the longest distance."""

_DARKEST = 0.05
_LIGHTNESS = 0.25
"""Colours are compared by the shares of their channels and, with this weight, by the logarithm of their brightness."""

_GREY = 0.1
"""Added to the brightness that saturation is relative to: a dark plum counts as colourful, black does not."""


@dataclass(slots=True)
class InnerScene(FineScene):
    """One picture being read, with an eye on what is in vessels."""

    blocks: ClassVar[tuple[int, ...]] = (*FineScene.blocks, 3 * STRETCHED_SIDE**2)
    components: ClassVar[tuple[int, ...]] = (*FineScene.components, 24)
    _stretched: dict[str, Vector] = field(default_factory=dict)

    def _compute_crops(self, name: str) -> Vector | None:
        crops = FineScene._compute_crops(self, name)
        if crops is None:
            return None
        self._stretched[name] = self._stretch(self.picture.boxes[name])
        return np.concatenate([crops, self._stretched[name].ravel()])

    def _stretch(self, box: Box) -> Vector:
        wide, high = box.width * _MARGIN, box.height * _MARGIN
        area = (
            max(0.0, box.left - wide), max(0.0, box.top - high),
            min(float(self.image.width), box.right + wide), min(float(self.image.height), box.bottom + high),
        )  # fmt: skip
        side = (STRETCHED_SIDE, STRETCHED_SIDE)
        small = np.asarray(self.image.resize(side, PIL.Image.Resampling.BOX, box=area), dtype=np.float32)
        part: Vector = small / np.float32(255)
        return part

    def relation(self, a: str, b: str) -> Vector:
        """As with the finer sight, then how like the colour of ``a`` is to what ``b`` shows above and below."""
        relation = FineScene.relation(self, a, b)
        return np.concatenate([relation, _likeness(self._stretched[a], self._stretched[b])])


def _likeness(first: Vector, second: Vector) -> Vector:
    """How much of the opening and of the wall of ``second`` has the strongest colour of ``first``."""
    mine, seen = _hue(_strongest(first)), _hue(second)
    apart = np.sqrt(((seen - mine) ** 2).sum(axis=2))
    found: list[float] = []
    for part in (apart[_OPENING], apart[_BELOW]):
        found += [float((part < like).mean()) for like in _LIKE]
        found += np.minimum(np.quantile(part, _SHARES), _FARTHEST).tolist()
    inner = np.median(second[_MIDDLE].reshape(-1, 3), axis=0)
    hue = _hue(inner)
    return np.array([*found, *inner, *(hue - mine), *hue, inner.max() - inner.min()], dtype=np.float32)


def _hue(colours: NDArray[np.float32]) -> NDArray[np.float32]:
    """Shares of red, green and blue, and the weighed logarithm of the sum."""
    total = np.maximum(colours.sum(axis=-1, keepdims=True), _DARKEST)
    return np.concatenate([colours / total, _LIGHTNESS * np.log(total)], axis=-1)


def _strongest(crop: Vector) -> Vector:
    """The mean colour of the most saturated fifth of a stretched box's middle."""
    middle = crop[4:-4, 4:-4].reshape(-1, 3)
    brightest = middle.max(axis=1)
    saturation = (brightest - middle.min(axis=1)) / (brightest + _GREY)
    colour: Vector = middle[np.argsort(saturation, kind="stable")[-len(middle) // 5 :]].mean(axis=0)
    return colour
