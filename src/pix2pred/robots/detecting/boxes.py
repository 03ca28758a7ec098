"""Boxes as vision-language models write them, in pixels of the picture: whatever scale and order they were asked in.

Models write corners in pixels, in thousandths of the picture's sides, or in shares of them; and x before y, or y
before x. One answer keeps to one of each, which is told from all its boxes together, or given.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

from pix2pred.robots.detecting.detector import clipped
from pix2pred.structs import Box


class Scale(Enum):
    """In which unit corners are written."""

    PIXELS = "pixels"
    THOUSANDTHS = "thousandths"
    SHARES = "shares"


class Order(Enum):
    """Which of a corner's numbers comes first."""

    X_Y = "x y"
    Y_X = "y x"


@dataclass(frozen=True, slots=True)
class Convention:
    """How a model writes boxes.

    ``scale`` is the unit of the numbers; ``order`` tells which of a corner's numbers comes first.
    """

    scale: Scale
    order: Order


@dataclass(frozen=True, slots=True)
class WrittenBox:
    """Four numbers as written, and the label beside them."""

    numbers: tuple[float, float, float, float]
    label: str = ""
    y_first: bool | None = None
    """What the name of the list says of the order, where it says something."""


THOUSAND = 1000.0

_NUMBERS = re.compile(r"\[\s*(-?[\d.]+)\s*,\s*(-?[\d.]+)\s*,\s*(-?[\d.]+)\s*,\s*(-?[\d.]+)\s*\]")
_LOCATIONS = re.compile(r"<loc(\d{4})><loc(\d{4})><loc(\d{4})><loc(\d{4})>\s*([\w -]*)")
_LOCATION_SCALE = THOUSAND / 1024
"""Location tokens count 1024ths, y first."""

_KEYS = {"bbox_2d": None, "bbox": None, "box": None, "box_2d": True, "coordinates": None}
"""Names of the list in JSON answers; ``box_2d`` is y first by those who use it."""

_LABELS = ("label", "name", "object", "description")


def written_boxes(answer: str) -> list[WrittenBox]:
    """The boxes in a model's answer: JSON objects, bare lists of four numbers, or location tokens."""
    found = [box for data in _json_values(answer) for box in _from_json(data)]
    if found:
        return found
    tokens = _LOCATIONS.findall(answer)
    if tokens:
        return [WrittenBox(_four([float(v) * _LOCATION_SCALE for v in t[:4]]), t[4].strip(), True) for t in tokens]
    return [WrittenBox(_four([float(v) for v in four])) for four in _NUMBERS.findall(answer)]


def convention_of(boxes: Sequence[WrittenBox], size: tuple[int, int]) -> Convention:
    """How the boxes of one answer are written, for a picture of the given (width, height).

    Shares are at most 1. Numbers beyond the picture's longer side are thousandths; else pixels, unless the order that
    would put them into the picture rules it out. The order is x before y unless the answer says otherwise, or unless
    only the other one puts all corners into the picture.
    """
    highest = max((max(b.numbers) for b in boxes), default=0.0)
    said = next((b.y_first for b in boxes if b.y_first is not None), None)
    if highest <= 1.0:
        return Convention(Scale.SHARES, Order.Y_X if said else Order.X_Y)
    if said:  # those who write y first write thousandths
        return Convention(Scale.THOUSANDTHS, Order.Y_X)
    for order in (Order.X_Y, Order.Y_X):
        if all(_within(b, size, order) for b in boxes):
            return Convention(Scale.PIXELS, order)
    return Convention(Scale.THOUSANDTHS, Order.X_Y)


def normalised(box: WrittenBox, size: tuple[int, int], how: Convention) -> Box | None:
    """The box in pixels, clipped to the picture; None when nothing of it is inside, or when it has no extent."""
    a, b, c, d = box.numbers
    left, top, right, bottom = (a, b, c, d) if how.order is Order.X_Y else (b, a, d, c)
    width, height = size
    unit = {Scale.PIXELS: (1.0, 1.0), Scale.SHARES: (width, height)}.get(
        how.scale, (width / THOUSAND, height / THOUSAND)
    )
    left, right = sorted((left * unit[0], right * unit[0]))
    top, bottom = sorted((top * unit[1], bottom * unit[1]))
    return clipped(Box(left, top, right, bottom), size)


def _within(box: WrittenBox, size: tuple[int, int], order: Order) -> bool:
    a, b, c, d = box.numbers
    xs, ys = ((a, c), (b, d)) if order is Order.X_Y else ((b, d), (a, c))
    return max(xs) <= size[0] and max(ys) <= size[1] and xs[0] <= xs[1] and ys[0] <= ys[1]


def _four(values: Sequence[float]) -> tuple[float, float, float, float]:
    a, b, c, d = values
    return a, b, c, d


def _json_values(text: str) -> Iterator[Any]:
    """The JSON values in a text, which may stand in a fenced block or among words."""
    decoder, at = json.JSONDecoder(), 0
    while at < len(text):
        if text[at] in "[{":
            try:
                value, at = decoder.raw_decode(text, at)
                yield value
                continue
            except json.JSONDecodeError:
                pass
        at += 1


def _from_json(data: Any) -> Iterator[WrittenBox]:
    if isinstance(data, list):
        for entry in data:
            if isinstance(entry, dict | list):
                yield from _from_json(entry)
    elif isinstance(data, dict):
        for key, y_first in _KEYS.items():
            numbers = data.get(key)
            if isinstance(numbers, list) and len(numbers) == 4 and all(isinstance(v, int | float) for v in numbers):
                label = next((str(data[k]) for k in _LABELS if k in data), "")
                yield WrittenBox(_four([float(v) for v in numbers]), label, y_first)
                return
        for value in data.values():
            if isinstance(value, dict | list):
                yield from _from_json(value)
