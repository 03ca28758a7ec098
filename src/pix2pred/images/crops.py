"""The part of the scene a skill was about (method 3.4)."""

from __future__ import annotations

from collections.abc import Iterable

from pix2pred.structs import Box, State

PADDING = 0.15
"""Added on every side, as a share of the union's longer side."""

MIN_PADDING = 8.0
"""Pixels added on every side at least."""


def skill_crop(before: State, after: State, names: Iterable[str], camera: int, size: tuple[int, int]) -> Box | None:
    """The padded union of the boxes of ``names`` in both states, inside a picture of ``size``; ``None`` without any."""
    wanted = list(names)
    boxes = [
        picture.boxes[name]
        for picture in (before.pictures[camera], after.pictures[camera])
        for name in wanted
        if name in picture.boxes
    ]
    if not boxes:
        return None
    union = boxes[0]
    for box in boxes[1:]:
        union = union.union(box)
    pad = max(MIN_PADDING, PADDING * max(union.width, union.height))
    width, height = size
    crop = Box(
        max(0.0, union.left - pad), max(0.0, union.top - pad),
        min(float(width), union.right + pad), min(float(height), union.bottom + pad),
    )  # fmt: skip
    return crop if crop.width >= 1 and crop.height >= 1 else None
