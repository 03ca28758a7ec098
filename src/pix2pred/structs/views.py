"""What is shown of a picture: a crop, a size, marks and a heading, drawn only when a model is asked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from textwrap import wrap
from typing import Any

from pix2pred.structs.states import Box, Picture

LONGEST_SIDE = 512
"""Pixels of the longer side of a shown picture (method 3.9)."""


HEADING_HEIGHT = 26
"""Pixels of the white strip above a picture that holds its heading."""

FOOT_HEIGHT = 20
"""Pixels of the strip below a picture, for the names of objects at its lower edge."""

NOTE_HEIGHT = 22
"""Pixels of a row of the white strip below a picture that names the objects it does not show."""

NOTE_LETTER, NOTE_MARGIN = 6, 8
"""Pixels that a letter of that strip is given, and those left free on either side; wide letters make small type."""


@dataclass(frozen=True, slots=True)
class View:
    """A clean picture and how to show it.

    ``crop`` is in the picture's pixels; ``marks`` draws every boxed object's name beside it (set-of-marks);
    ``heading`` is written on a white strip above the picture; below a whole picture stands which objects are ``unseen``
    in it, which follows from the boxes and the question's text and is no part of what identifies a question.
    """

    picture: Picture
    state: int
    crop: Box | None = None
    marks: bool = True
    heading: str = ""
    longest_side: int = LONGEST_SIDE
    unseen: tuple[str, ...] = field(default=(), compare=False)

    @property
    def note(self) -> str:
        """What is written below the picture."""
        return (
            f"without a mark, hidden or out of view: {', '.join(self.unseen)}" if self.unseen and not self.crop else ""
        )

    @property
    def note_rows(self) -> tuple[str, ...]:
        """The note in rows that fit below the picture; a name that is longer than a row stands in one alone."""
        letters = max(1, (self._scene_size[0] - 2 * NOTE_MARGIN) // NOTE_LETTER)
        return tuple(wrap(self.note, letters, break_long_words=False, break_on_hyphens=False))

    @property
    def boxes(self) -> Mapping[str, Box]:
        """The boxes of objects, in the picture's pixels, by name in sorted order."""
        return dict(sorted(self.picture.boxes.items()))

    @property
    def _scene_size(self) -> tuple[int, int]:
        width, height = map(float, self.picture.image.size)
        if self.crop:
            width, height = self.crop.width, self.crop.height
        factor = scale_to(width, height, self.longest_side)
        return max(1, round(width * factor)), max(1, round(height * factor))

    @property
    def shown_size(self) -> tuple[int, int]:
        """(width, height) in pixels of what is shown, strips for heading and names included."""
        width, height = self._scene_size
        strips = (HEADING_HEIGHT if self.heading else 0) + (FOOT_HEIGHT if self.marks and self.boxes else 0)
        return width, height + strips + NOTE_HEIGHT * len(self.note_rows)

    def canonical(self) -> dict[str, Any]:
        """Everything that decides what is shown, JSON-compatible; equal for equal views on any machine."""
        return {
            "pixels": self.picture.image.digest,
            "camera": self.picture.camera,
            "state": self.state,
            "crop": _numbers(self.crop) if self.crop else None,
            "marks": self.marks,
            "heading": self.heading,
            "longest_side": self.longest_side,
            "boxes": {name: _numbers(box) for name, box in self.boxes.items()},
        }


def _numbers(box: Box) -> list[float]:
    return [float(box.left), float(box.top), float(box.right), float(box.bottom)]


def scale_to(width: float, height: float, longest_side: int) -> float:
    """The factor that gives a picture of ``width`` x ``height`` the longer side ``longest_side``."""
    factor = longest_side / max(width, height)
    assert math.isfinite(factor) and factor > 0, "a picture has a positive size"
    return factor
