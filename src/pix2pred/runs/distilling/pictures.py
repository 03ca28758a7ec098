"""The pictures of looks that were labelled: found in the stores of a run by the digest of their pixels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pix2pred.structs import Box, Image, Picture
from pix2pred.vlm import AnswerStore

Corners = Sequence[float]
"""left, top, right, bottom in pixels."""


@dataclass(frozen=True, slots=True)
class Stores:
    """Answer stores, any of which may hold a picture."""

    stores: Sequence[AnswerStore]

    def picture(self, camera: str, digest: str, boxes: Mapping[str, Corners]) -> Picture | None:
        """The picture with these pixels and boxes; ``None`` when no store has it."""
        for store in self.stores:
            path = store.blob(digest)
            if path.is_file():
                return Picture(camera, Image(path), {name: Box(*corners) for name, corners in sorted(boxes.items())})
        return None
