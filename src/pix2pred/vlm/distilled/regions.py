"""Which parts of a picture an atom is about: the boxes of its objects, what they share, and how they lie.

An object that no picture of a look has a box of is looked for in the whole picture, and is known by its name alone:
that is all that plain photos allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import PIL.Image

from pix2pred.structs import Box, Picture
from pix2pred.vlm.distilled.sight import UNCHANGED, Array, Augmentation, PicturePyramid, see
from pix2pred.vlm.offline.label_question import Look
from pix2pred.vlm.offline.pixels import is_blank

Kinds = tuple[str, ...]
"""What an atom is about: the type of each object, or its name after ``@`` where nobody says where it is."""

SHARED = "@shared"
"""The kind of the region that the objects of an atom share."""
SCENE = "@scene"
"""The kind of the whole picture, for atoms about nothing in particular."""
PICTURE = "@picture"
"""The kind of the whole picture, whatever an atom is about: in a place that was never seen all is strange."""
RELATION = 6
"""Numbers that say how a second box lies to a first."""
_FARTHEST = 3.0
"""Offsets are counted in sizes of the first box, up to this."""
COMPANION = RELATION + 2
"""Numbers about the nearest object of a type: how it lies, whether there is one, and how many there are."""


@dataclass(slots=True)
class PictureSeen:
    """One picture of a look, and what its regions show."""

    look: Look
    picture: Picture
    _shown: PicturePyramid | None = None
    _blank: dict[str, bool] = field(default_factory=dict)

    @property
    def shown(self) -> PicturePyramid:
        """The picture, unpacked when something in it is looked at: half of the time, where there are many cameras."""
        if self._shown is None:
            self._shown = PicturePyramid([PIL.Image.fromarray(self.picture.image.pixels())])
        return self._shown

    def kinds(self, names: Sequence[str]) -> Kinds | None:
        """The kinds of the objects; ``None`` when one of them has no box here but has one elsewhere."""
        kinds = tuple(self._kind(name) for name in names)
        return None if "" in kinds else kinds

    def _kind(self, name: str) -> str:
        if name in self.picture.boxes:
            return self.look.types.get(name, "")
        return "" if any(name in p.boxes for p in self.look.pictures) or not self._is_boxless() else f"@{name}"

    def _is_boxless(self) -> bool:
        """Whether nothing at all has a box: an object without one among others that have one is out of sight."""
        return not any(p.boxes for p in self.look.pictures)

    def shows(self, names: Sequence[str]) -> bool:
        """Whether none of the boxes is blank."""
        for name in names:
            if name not in self._blank:
                self._blank[name] = is_blank(self.shown.copy(0), self.box(name))
        return not any(self._blank[name] for name in names)

    def box(self, name: str) -> Box:
        """The object's box, or the whole picture."""
        return self.picture.boxes.get(name) or self.whole

    @property
    def whole(self) -> Box:
        """The whole picture."""
        return Box(0.0, 0.0, *map(float, self.shown.size))

    def vectors(self, regions: Sequence[tuple[str, ...]], change: Augmentation = UNCHANGED) -> Array:
        """One vector for each region, given as the names of the objects in it; none for the whole picture."""
        return see(self.shown, [self._region(names) for names in regions], [change] * len(regions))

    def _region(self, names: tuple[str, ...]) -> Box:
        if not names:
            return self.whole
        region = self.box(names[0])
        for name in names[1:]:
            region = region.union(self.box(name))
        return region

    def relation(self, names: Sequence[str], company: Sequence[str]) -> Array:
        """How the box of each object after the first lies to that of the one before: RELATION numbers for each.

        Of an object alone, how what it shares most of its box with lies, of each type in ``company``: COMPANION numbers
        for each. What stands on a table, or whether something does, shows in the boxes better than in the pixels.
        """
        if len(names) == 1 and names[0] in self.picture.boxes:
            return np.concatenate([np.zeros(0), *(self._companion(names[0], t) for t in company)], dtype=np.float32)
        boxes = [self.box(name) for name in names]
        pairs = [_relation(a, b) for a, b in pairwise(boxes)]
        return np.array([number for pair in pairs for number in pair], dtype=np.float32)

    def _companion(self, name: str, kind: str) -> Array:
        own = self.picture.boxes[name]
        others = [
            _relation(own, box)
            for other, box in sorted(self.picture.boxes.items())
            if other != name and self.look.types.get(other) == kind
        ]
        if not others:
            return np.zeros(COMPANION, dtype=np.float32)
        nearest = min(others, key=lambda r: (-r[-1], r[0] ** 2 + r[1] ** 2))
        within = sum(abs(r[0]) < 0.5 and abs(r[1]) < 0.5 for r in others)
        return np.array([*nearest, 1.0, min(within, _FARTHEST)], dtype=np.float32)


def _relation(first: Box, second: Box) -> tuple[float, ...]:
    width, height = max(first.width, 1.0), max(first.height, 1.0)
    across = min(first.right, second.right) - max(first.left, second.left)
    down = min(first.bottom, second.bottom) - max(first.top, second.top)
    least = max(1.0, min(width * height, second.width * second.height))
    return (
        _bounded((second.center[0] - first.center[0]) / width),
        _bounded((second.center[1] - first.center[1]) / height),
        _bounded((second.bottom - first.bottom) / height),
        _bounded((second.top - first.top) / height),
        _bounded(float(np.log(max(second.width * second.height, 1.0) / (width * height)))),
        max(0.0, across) * max(0.0, down) / least,
    )


def _bounded(number: float) -> float:
    return max(-_FARTHEST, min(_FARTHEST, number))


def regions_of(names: tuple[str, ...]) -> list[tuple[str, ...]]:
    """The regions an atom is about: of each object, and of all together; or the whole picture."""
    alone: list[tuple[str, ...]] = [(name,) for name in names]
    return [*alone, names] if len(names) > 1 else alone or [()]


def kinds_of_regions(kinds: Kinds) -> list[str]:
    """The kinds of the regions that ``regions_of`` gives for objects of ``kinds``."""
    return [*kinds, SHARED] if len(kinds) > 1 else list(kinds) or [SCENE]


Names = tuple[str, ...]
