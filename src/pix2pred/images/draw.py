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
_LABEL_TEXT = (255, 70, 60, 255)
_LABEL_BACK = (0, 0, 0, 150)


def draw_view(view: View) -> Pixels:
    """The picture as a model sees it, shape (height, width, 3)."""
    source = PILImage.fromarray(view.picture.image.pixels())
    crop = view.crop or Box(0, 0, source.width, source.height)
    factor = scale_to(crop.width, crop.height, view.longest_side)
    size = (max(1, round(crop.width * factor)), max(1, round(crop.height * factor)))
    shown = source.resize(size, PILImage.Resampling.LANCZOS, box=(crop.left, crop.top, crop.right, crop.bottom))
    if view.marks:
        shown = _draw_marks(shown, _visible_boxes(view, crop, factor))
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
    layer = PILImage.new("RGBA", image.size)
    draw = ImageDraw.Draw(layer)
    placed: list[Box] = []
    for name, box in sorted(boxes.items(), key=lambda item: (-item[1].bottom, item[0])):
        left, top, right, bottom = draw.textbbox((0, 0), name, font=font)
        width, height = right - left + 6, bottom - top + 5
        others = [b for n, b in boxes.items() if n != name]
        spot = min(
            _spots(box, width, height, image.size),
            key=lambda s: (sum(_overlap(s, p) for p in placed), sum(_overlap(s, o) for o in others)),
        )
        placed.append(spot)
        draw.rounded_rectangle((spot.left, spot.top, spot.right, spot.bottom), 3, fill=_LABEL_BACK)
        draw.text((spot.left + 3 - left, spot.top + 2 - top), name, font=font, fill=_LABEL_TEXT)
        _draw_leader(draw, spot, box)
    return PILImage.alpha_composite(image.convert("RGBA"), layer)


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


def _draw_leader(draw: ImageDraw.ImageDraw, spot: Box, box: Box) -> None:
    """A thin line from a label that had to move away to its object."""
    nearest = (min(max(spot.center[0], box.left), box.right), min(max(spot.center[1], box.top), box.bottom))
    if spot.top > box.bottom + 4 or spot.bottom < box.top - 4:
        draw.line((*spot.center, *nearest), fill=_LABEL_TEXT, width=1)


def _draw_heading(image: PILImage.Image, heading: str) -> PILImage.Image:
    taller = PILImage.new("RGB", (image.width, image.height + HEADING_HEIGHT), "white")
    taller.paste(image.convert("RGB"), (0, HEADING_HEIGHT))
    font = ImageFont.load_default(FONT_SIZE + 2)
    ImageDraw.Draw(taller).text((8, HEADING_HEIGHT / 2), heading, font=font, fill="black", anchor="lm")
    return taller
