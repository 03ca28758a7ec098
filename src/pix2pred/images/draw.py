"""Drawing a view: crop, resize, marks, heading (method 2.1: set-of-marks and timestep headings)."""

from __future__ import annotations

import io
from collections.abc import Iterator

import numpy as np
from PIL import Image as PILImage
from PIL import ImageDraw, ImageFont

from pix2pred.structs import Box, Pixels
from pix2pred.structs.views import View, scale_to

FONT_SIZE = 13
HEADING_HEIGHT = 26
FOOT_HEIGHT = 20
"""Room below the picture for the names of objects at its lower edge."""

_LABEL_TEXT = (255, 236, 120, 255)
_LABEL_BACK = (0, 0, 0, 200)


def draw_view(view: View) -> Pixels:
    """The picture as a model sees it, shape (height, width, 3)."""
    source = PILImage.fromarray(view.picture.image.pixels())
    crop = view.crop or Box(0, 0, source.width, source.height)
    factor = scale_to(crop.width, crop.height, view.longest_side)
    size = (max(1, round(crop.width * factor)), max(1, round(crop.height * factor)))
    shown = source.resize(size, PILImage.Resampling.LANCZOS, box=(crop.left, crop.top, crop.right, crop.bottom))
    boxes = _visible_boxes(view, crop, factor) if view.marks else {}
    if boxes:
        shown = _draw_marks(shown, boxes)
    if view.heading:
        shown = _draw_heading(shown, view.heading)
    return np.asarray(shown.convert("RGB"), dtype=np.uint8)


def encode_png(pixels: Pixels) -> bytes:
    """Lossless encoding for sending and for looking at."""
    buffer = io.BytesIO()
    PILImage.fromarray(pixels).save(buffer, "PNG")
    return buffer.getvalue()


def _visible_boxes(view: View, crop: Box, factor: float) -> dict[str, Box]:
    """Boxes with their centre inside the crop, in the pixels of the shown picture."""
    shown = {}
    for name, box in view.boxes.items():
        x, y = box.center
        if crop.left <= x < crop.right and crop.top <= y < crop.bottom:
            shown[name] = Box(
                (box.left - crop.left) * factor, (box.top - crop.top) * factor,
                (box.right - crop.left) * factor, (box.bottom - crop.top) * factor,
            )  # fmt: skip
    return shown


def _draw_marks(image: PILImage.Image, boxes: dict[str, Box]) -> PILImage.Image:
    """Write each object's name beside it, where it covers the fewest other objects and no other name."""
    font = ImageFont.load_default(FONT_SIZE)
    taller = PILImage.new("RGBA", (image.width, image.height + FOOT_HEIGHT), "white")
    taller.paste(image.convert("RGBA"), (0, 0))
    layer = PILImage.new("RGBA", taller.size)
    draw = ImageDraw.Draw(layer)
    placed: list[Box] = []
    for name, box in sorted(boxes.items(), key=lambda item: (-item[1].bottom, item[0])):
        left, top, right, bottom = draw.textbbox((0, 0), name, font=font)
        width, height = right - left + 6, bottom - top + 5
        others = [b for n, b in boxes.items() if n != name]
        spot = min(
            _spots(box, width, height, taller.size),
            key=lambda s: (
                sum(_overlap(s, p) for p in placed),
                sum(_overlap(s, o) for o in others) + 200 * sum(_distance(s, o) < _distance(s, box) for o in others),
            ),
        )
        placed.append(spot)
        draw.rounded_rectangle((spot.left, spot.top, spot.right, spot.bottom), 3, fill=_LABEL_BACK)
        draw.text((spot.left + 3 - left, spot.top + 2 - top), name, font=font, fill=_LABEL_TEXT)
        _draw_leader(draw, spot, box)
    return PILImage.alpha_composite(taller, layer)


def _spots(box: Box, width: float, height: float, size: tuple[int, int]) -> Iterator[Box]:
    """Places for a label, best first: under the object, beside its lower edge, above it; all inside the picture."""
    x, _ = box.center
    for left, top in (
        (x - width / 2, box.bottom + 1),
        (box.left - width - 2, box.bottom - height),
        (box.right + 2, box.bottom - height),
        (x - width / 2, box.top - height - 1),
        (box.left - width - 2, box.top),
        (box.right + 2, box.top),
        (x - width / 2, box.bottom - height),
        (x - width / 2, box.bottom + height + 2),
        (x - width / 2, box.top - 2 * height - 2),
    ):
        left = min(max(left, 0), max(0, size[0] - width))
        top = min(max(top, 0), max(0, size[1] - height))
        yield Box(round(left), round(top), round(left + width), round(top + height))


def _overlap(a: Box, b: Box) -> float:
    width = min(a.right, b.right) - max(a.left, b.left)
    height = min(a.bottom, b.bottom) - max(a.top, b.top)
    return max(0.0, width) * max(0.0, height)


def _distance(spot: Box, box: Box) -> float:
    """How far a label's centre is from a box; 0 inside it."""
    x, y = spot.center
    dx = max(box.left - x, 0.0, x - box.right)
    dy = max(box.top - y, 0.0, y - box.bottom)
    return float(np.hypot(dx, dy))


def _draw_leader(draw: ImageDraw.ImageDraw, spot: Box, box: Box) -> None:
    """A line from a label to its object, unless the label stands right below or above it, or on it and it is large."""
    x = spot.center[0]
    under = abs(x - box.center[0]) < box.width / 2 and min(abs(spot.top - box.bottom), abs(spot.bottom - box.top)) < 6
    on_it = _overlap(spot, box) > 0 and box.height > 8 * spot.height
    if not (under or on_it):
        inset = min(6.0, box.width / 4, box.height / 4)
        # the lower edge of an object is what shows when others lie on it
        end = (min(max(x, box.left + inset), box.right - inset), box.bottom - inset)
        start = (min(max(end[0], spot.left), spot.right), min(max(end[1], spot.top), spot.bottom))
        draw.line((*start, *end), fill=_LABEL_BACK, width=4)
        draw.line((*start, *end), fill=_LABEL_TEXT, width=2)
        draw.ellipse((end[0] - 3, end[1] - 3, end[0] + 3, end[1] + 3), fill=_LABEL_TEXT, outline=(0, 0, 0, 255))


def _draw_heading(image: PILImage.Image, heading: str) -> PILImage.Image:
    taller = PILImage.new("RGB", (image.width, image.height + HEADING_HEIGHT), "white")
    taller.paste(image.convert("RGB"), (0, HEADING_HEIGHT))
    font = ImageFont.load_default(FONT_SIZE + 2)
    ImageDraw.Draw(taller).text((8, HEADING_HEIGHT / 2), heading, font=font, fill="black", anchor="lm")
    return taller
