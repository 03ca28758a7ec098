"""Drawing a view: crop, resize, marks, heading (method 2.1: set-of-marks and timestep headings)."""

from __future__ import annotations

import io
from bisect import bisect
from collections.abc import Callable
from functools import cache, lru_cache

import numpy as np
from PIL import Image as PILImage
from PIL import ImageDraw, ImageFont

from pix2pred.images.marks import Point, place_names
from pix2pred.structs import Box, Image, Pixels
from pix2pred.structs.views import FOOT_HEIGHT, HEADING_HEIGHT, NOTE_HEIGHT, View, scale_to

FONT_SIZE = 13
LEAST_FONT_SIZE = 9
"""Points: the smallest type that models still read."""
_MARGIN = 8

_LABEL_TEXT = (255, 236, 120, 255)
_LABEL_BACK = (0, 0, 0, 200)

Decode = Callable[[Image], Pixels]
"""The pixels of a picture."""


def draw_view(view: View) -> Pixels:
    """The picture as a model sees it, shape (height, width, 3): between its heading and its note, if it has them."""
    scene = draw_scene(view)
    strips = [draw_heading(view.heading, scene.shape[1])] if view.heading else []
    return np.concatenate([*strips, scene, *(draw_note(row, scene.shape[1]) for row in view.note_rows)])


def draw_scene(view: View, decode: Decode = Image.pixels) -> Pixels:
    """The view without its heading."""
    source = PILImage.fromarray(decode(view.picture.image))
    crop = view.crop or Box(0, 0, source.width, source.height)
    factor = scale_to(crop.width, crop.height, view.longest_side)
    size = (max(1, round(crop.width * factor)), max(1, round(crop.height * factor)))
    box = (crop.left, crop.top, crop.right, crop.bottom)
    as_it_is = (*source.size, box) == (*size, (0, 0, *size))
    shown = source if as_it_is else source.resize(size, PILImage.Resampling.LANCZOS, box=box)
    boxes = _visible_boxes(view, crop, factor) if view.marks else {}
    return np.asarray(_draw_marks(shown, boxes) if boxes else shown, dtype=np.uint8)


def draw_heading(heading: str, width: int) -> Pixels:
    """A white strip with the heading, shape (HEADING_HEIGHT, width, 3)."""
    return _strip(heading, width, HEADING_HEIGHT, FONT_SIZE + 2)


def draw_note(note: str, width: int) -> Pixels:
    """A white strip with a row of the note, shape (NOTE_HEIGHT, width, 3)."""
    return _strip(note, width, NOTE_HEIGHT, FONT_SIZE)


def _strip(text: str, width: int, height: int, font_size: int) -> Pixels:
    """Text in the largest type that fits, at most ``font_size``; what fits in none is cut and ends in dots."""
    strip = PILImage.new("RGB", (width, height), "white")
    draw, room, text = ImageDraw.Draw(strip), width - 2 * _MARGIN, text.replace("\n", " ")
    for size in range(font_size, LEAST_FONT_SIZE - 1, -1):
        if draw.textlength(text, _font(size)) <= room:
            break
    else:
        lengths = [draw.textlength(f"{text[:n]}...", _font(size)) for n in range(len(text))]
        text = f"{text[: max(0, bisect(lengths, room) - 1)]}..."
    draw.text((_MARGIN, height / 2), text, font=_font(size), fill="black", anchor="lm")
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
    """Write each object's name beside it."""
    taller = image.crop((0, 0, image.width, image.height + FOOT_HEIGHT))
    taller.paste("white", (0, image.height, *taller.size))
    blending = ImageDraw.Draw(taller, "RGBA")
    labels = {name: _label(name) for name in boxes}
    sizes = {name: (label.width - 1, label.height - 1) for name, label in labels.items()}
    marks = place_names(boxes, sizes, taller.size)
    for mark in marks:
        if mark.line:
            _draw_line(blending, *mark.line)
    for mark in marks:  # names last: no line is drawn over one
        _write(taller, labels[mark.name], mark.spot)
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


def _draw_line(draw: ImageDraw.ImageDraw, start: Point, end: Point) -> None:
    """A line from a name to its object, with a dot where it ends."""
    draw.line((*start, *end), fill=_LABEL_BACK, width=4)
    draw.line((*start, *end), fill=_LABEL_TEXT, width=2)
    draw.ellipse((end[0] - 3, end[1] - 3, end[0] + 3, end[1] + 3), fill=_LABEL_TEXT, outline=(0, 0, 0, 255))
