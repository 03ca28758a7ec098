"""What a detector is: boxes with scores for the words that describe objects, and the pixels within a box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pix2pred.structs import Box, Image

Mask = NDArray[np.bool_]
"""Which pixels of a picture belong to an object, shape (height, width)."""


@dataclass(frozen=True, slots=True)
class Detection:
    """A box around what fits a description, and how sure the detector is, between 0 and 1."""

    descriptor: str
    box: Box
    score: float


class Detector(Protocol):
    """Finds described objects in a picture."""

    def detect(self, picture: Image, descriptors: Sequence[str]) -> Sequence[Detection]:
        """Boxes within the picture, the surest first. A description may have none, or several."""
        ...


class Segmenter(Protocol):
    """Tells an object from its surroundings."""

    def segment(self, picture: Image, boxes: Sequence[Box]) -> Sequence[Mask]:
        """The pixels of the object in each box, in the boxes' order."""
        ...


def clipped(box: Box, size: tuple[int, int]) -> Box | None:
    """The part of a box within a picture of the given (width, height); None when nothing of it is there."""
    width, height = size
    inside = Box(max(0.0, box.left), max(0.0, box.top), min(float(width), box.right), min(float(height), box.bottom))
    return inside if inside.width > 0 and inside.height > 0 else None


def best_boxes(found: Sequence[Detection], names: Mapping[str, str]) -> dict[str, Box]:
    """The surest box for every name; ``names`` gives each object's description. Equal descriptions share boxes out.

    Two objects with the same description get different boxes, the surest going to the first by name.
    """
    left: dict[str, list[Detection]] = {}
    for detection in sorted(found, key=lambda d: -d.score):
        left.setdefault(detection.descriptor, []).append(detection)
    boxes = {}
    for name in sorted(names):
        if left.get(names[name]):
            boxes[name] = left[names[name]].pop(0).box
    return boxes


def whole_box(size: tuple[int, int], box: Box) -> Mask:
    """Every pixel of a box: the outline where nothing better is known."""
    mask = np.zeros((size[1], size[0]), dtype=np.bool_)
    rows, columns = slice(int(box.top), int(np.ceil(box.bottom))), slice(int(box.left), int(np.ceil(box.right)))
    mask[rows, columns] = True
    return mask
