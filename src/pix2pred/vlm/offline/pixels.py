"""Numbers the offline reader computes from a clean picture and boxes: crops, neighbours, simple measures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from pix2pred.structs import Box, Picture

Vector = NDArray[np.float32]

SIDE = 16
"""Crops are resized to SIDE x SIDE pixels."""

TIGHT, WIDE = 1.1, 2.2
"""Sides of the two crops of an object, relative to the longer side of its box."""

SAME_SCALE = 640
"""A picture higher than this many pixels is taken to show more, not the same larger: offsets are relative to this."""

FARTHEST = 1.0
"""Offsets between boxes count up to this: no picture of ordinary height has longer ones."""

BLANK_DEVIATION = 2.0
"""A box whose grey values deviate less than this (of 255) shows nothing."""


def is_blank(image: PIL.Image.Image, box: Box) -> bool:
    """Whether a box shows nothing: it is empty, lies outside, or holds one grey value alone."""
    area = (round(box.left), round(box.top), round(box.right), round(box.bottom))
    if area[2] <= area[0] or area[3] <= area[1]:
        return True
    return bool(np.asarray(image.crop(area).convert("L"), dtype=np.float32).std() < BLANK_DEVIATION)


@dataclass(slots=True)
class Scene:
    """One picture being read; crops, and what one reader makes of them, are kept: many words ask about an object.

    ``sights`` holds the latter by the names and types of one object or several.
    """

    blocks: ClassVar[tuple[int, ...]] = (SIDE**2 * 3, SIDE**2 * 3)
    """Lengths of the parts of a crop vector."""
    components: ClassVar[tuple[int, ...]] = (28, 12)
    """Principal components that training keeps of every part."""

    picture: Picture
    image: PIL.Image.Image = field(init=False)
    sights: dict[tuple[str, ...], Vector] = field(default_factory=dict)
    _crops: dict[str, Vector | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.image = PIL.Image.fromarray(self.picture.image.pixels())

    @property
    def scale(self) -> float:
        """The pixels that offsets and sizes are relative to: the picture's height, up to ``SAME_SCALE``."""
        return float(min(self.image.height, SAME_SCALE))

    def box(self, name: str) -> Box | None:
        """Where an object is, if a detector located it."""
        return self.picture.boxes.get(name)

    def crops(self, name: str) -> Vector | None:
        """The object's two crops as one vector with values in [0, 1]; ``None`` for a blank box or none at all."""
        if name not in self._crops:
            self._crops[name] = self._compute_crops(name)
        return self._crops[name]

    def _compute_crops(self, name: str) -> Vector | None:
        box = self.box(name)
        if box is None or box.width < 1 or box.height < 1 or is_blank(self.image, box):
            return None
        longest = max(box.width, box.height)
        parts = [self._square(box, longest * scale) for scale in (TIGHT, WIDE)]
        return np.concatenate(parts)

    def _square(self, box: Box, side: float) -> Vector:
        x, y = box.center
        area = (round(x - side / 2), round(y - side / 2), round(x + side / 2), round(y + side / 2))
        small = self.image.crop(area).resize((SIDE, SIDE), PIL.Image.Resampling.BOX)
        return (np.asarray(small, dtype=np.float32).ravel() / 255).astype(np.float32)

    def surroundings(self, name: str) -> Vector:
        """How the object's box lies among the others: sizes, nearest boxes above and below, containment.

        Offsets are relative to ``scale``; 1 stands for none.
        """
        box = self.picture.boxes[name]
        scale = self.scale
        x, y = box.center
        above = below = 1.0
        inside = contains = 0.0
        for other_name, other in sorted(self.picture.boxes.items()):
            if other_name == name:
                continue
            ox, oy = other.center
            if abs(ox - x) < 0.06 * scale:
                if other.bottom < box.bottom - 1:
                    above = min(above, (box.bottom - other.bottom) / scale)
                elif other.bottom > box.bottom + 1:
                    below = min(below, (other.bottom - box.bottom) / scale)
            if other.left <= x <= other.right and other.top <= y <= other.bottom:
                inside = max(inside, min(2.0, other.width / box.width))
            if box.left <= ox <= box.right and box.top <= oy <= box.bottom:
                contains = max(contains, min(2.0, box.width / other.width))
        size = (box.width / scale, box.height / scale)
        return np.array([*size, above, below, min(above, 0.2), min(below, 0.2), inside, contains], dtype=np.float32)

    def relation(self, a: str, b: str) -> Vector:
        """Where box ``b`` lies as seen from box ``a``, relative to ``scale``."""
        first, second = self.picture.boxes[a], self.picture.boxes[b]
        scale = self.scale
        offsets = (
            second.center[0] - first.center[0], second.center[1] - first.center[1], second.bottom - first.bottom
        )  # fmt: skip
        dx, dy, db = (max(-FARTHEST, min(FARTHEST, offset / scale)) for offset in offsets)
        near = (max(-1.0, min(1.0, 4 * offset)) for offset in (dx, dy, db))
        sizes = (first.width / scale, second.width / scale)
        return np.array([dx, dy, db, *near, abs(dx), abs(db), *sizes], dtype=np.float32)


def _channel(scene: Scene, name: str, pick: Callable[[Vector], float]) -> float | None:
    crop = scene.crops(name)
    return None if crop is None else pick(crop[: SIDE * SIDE * 3].reshape(-1, 3))


MEASURES: Mapping[str, Callable[..., float | None]] = {
    "brightness": lambda s, a: _channel(s, a, lambda rgb: float(rgb.mean())),
    "redness": lambda s, a: _channel(s, a, lambda rgb: float((rgb[:, 0] - rgb[:, 1]).mean())),
    "greenness": lambda s, a: _channel(s, a, lambda rgb: float((rgb[:, 1] - rgb[:, 0]).mean())),
    "contrast": lambda s, a: _channel(s, a, lambda rgb: float(rgb.std())),
    "blueness": lambda s, a: _channel(s, a, lambda rgb: float((rgb[:, 2] - rgb[:, 0]).mean())),
    "width": lambda s, a: s.box(a).width / min(s.image.width, SAME_SCALE),
    "x": lambda s, a: s.box(a).center[0] / s.image.width,
    "y": lambda s, a: s.box(a).center[1] / s.image.height,
    "dx": lambda s, a, b: float(s.relation(a, b)[0]),
    "dy": lambda s, a, b: float(s.relation(a, b)[1]),
    "distance": lambda s, a, b: float(np.hypot(*s.relation(a, b)[:2])),
}
"""What distractor words measure: of one object, or of a second object relative to the first."""
