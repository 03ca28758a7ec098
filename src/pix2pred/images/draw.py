"""Drawing a view: crop, resize, marks, heading (method 2.1: set-of-marks and timestep headings)."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator, Sequence
from functools import cache, lru_cache

import numpy as np
from PIL import Image as PILImage
from PIL import ImageDraw, ImageFont

from pix2pred.structs import Box, Image, Pixels
from pix2pred.structs.views import FOOT_HEIGHT, HEADING_HEIGHT, View, scale_to

FONT_SIZE = 13

_LABEL_TEXT = (255, 236, 120, 255)
_LABEL_BACK = (0, 0, 0, 200)
_OWN_OBJECT = 2000
"""What hiding an object by its own name weighs, as pixels of other objects: held things are small."""

Decode = Callable[[Image], Pixels]
"""The pixels of a picture."""


def draw_view(view: View) -> Pixels:
    """The picture as a model sees it, shape (height, width, 3): below its heading, if it has one."""
    scene = draw_scene(view)
    return np.concatenate([draw_heading(view.heading, scene.shape[1]), scene]) if view.heading else scene


def draw_scene(view: View, decode: Decode = Image.pixels) -> Pixels:
    """The view without its heading."""
    source = PILImage.fromarray(decode(view.picture.image))
    crop = view.crop or Box(0, 0, source.width, source.height)
    factor = scale_to(crop.width, crop.height, view.longest_side)
    size = (max(1, round(crop.width * factor)), max(1, round(crop.height * factor)))
    shown = source.resize(size, PILImage.Resampling.LANCZOS, box=(crop.left, crop.top, crop.right, crop.bottom))
    boxes = _visible_boxes(view, crop, factor) if view.marks else {}
    return np.asarray(_draw_marks(shown, boxes) if boxes else shown, dtype=np.uint8)


def draw_heading(heading: str, width: int) -> Pixels:
    """A white strip with the heading, shape (HEADING_HEIGHT, width, 3)."""
    strip = PILImage.new("RGB", (width, HEADING_HEIGHT), "white")
    ImageDraw.Draw(strip).text((8, HEADING_HEIGHT / 2), heading, font=_font(FONT_SIZE + 2), fill="black", anchor="lm")
    return np.asarray(strip, dtype=np.uint8)


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
    taller = PILImage.new("RGB", (image.width, image.height + FOOT_HEIGHT), "white")
    taller.paste(image, (0, 0))
    blending = ImageDraw.Draw(taller, "RGBA")
    placed: list[Box] = []
    for name, box in sorted(boxes.items(), key=lambda item: (-item[1].bottom, item[0])):
        label = _label(name)
        others = [b for n, b in boxes.items() if n != name]
        spot = _best(list(_spots(box, label.width - 1, label.height - 1, taller.size)), placed, others, box)
        placed.append(spot)
        _write(taller, label, spot)
        _draw_leader(blending, spot, box)
    return taller


@cache
def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)


@lru_cache(maxsize=1024)
def _label(name: str) -> PILImage.Image:
    """The name on a dark, slightly transparent ground: the same in every picture."""
    ruler = ImageDraw.Draw(PILImage.new("RGBA", (1, 1)))
    left, top, right, bottom = ruler.textbbox((0, 0), name, font=_font(FONT_SIZE))
    width, height = round(right - left) + 6, round(bottom - top) + 5
    label = PILImage.new("RGBA", (width + 1, height + 1))
    draw = ImageDraw.Draw(label)
    draw.rounded_rectangle((0, 0, width, height), 3, fill=_LABEL_BACK)
    draw.text((3 - left, 2 - top), name, font=_font(FONT_SIZE), fill=_LABEL_TEXT)
    return label


def _write(image: PILImage.Image, label: PILImage.Image, spot: Box) -> None:
    image.paste(label, (int(spot.left), int(spot.top)), label)


def _best(spots: Sequence[Box], placed: Sequence[Box], others: Sequence[Box], box: Box) -> Box:
    """The first of the spots that overlap the names placed before least and, of these, hide least.

    What a name may hide, in pixels: other objects, and its own, which counts more the larger the share of it is.
    """
    names = [sum(_overlap(s, p) for p in placed) for s in spots]
    free = [s for s, covered in zip(spots, names, strict=True) if covered == min(names)]
    best, least = free[0], math.inf
    for spot in free:
        own = _distance(spot, box)
        covered = sum(_overlap(spot, o) + 200 * (_distance(spot, o) < own) for o in others)
        covered += _OWN_OBJECT * _overlap(spot, box) / max(1.0, box.width * box.height)
        if covered < least:
            best, least = spot, covered
        if covered == 0:
            break
    return best


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
    if a.right <= b.left or b.right <= a.left or a.bottom <= b.top or b.bottom <= a.top:  # nearly always
        return 0.0
    return (min(a.right, b.right) - max(a.left, b.left)) * (min(a.bottom, b.bottom) - max(a.top, b.top))


def _distance(spot: Box, box: Box) -> float:
    """How far a label's centre is from a box; 0 inside it."""
    x, y = spot.center
    dx = max(box.left - x, 0.0, x - box.right)
    dy = max(box.top - y, 0.0, y - box.bottom)
    return math.hypot(dx, dy)


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
