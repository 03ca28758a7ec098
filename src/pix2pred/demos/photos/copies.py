"""Copies of photos that hold their pixels and nothing else."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import PIL.Image

from pix2pred.demos.photos.heic import heic_pixels, is_heic
from pix2pred.demos.pictures import PNG_START, load_picture
from pix2pred.structs import Image, Pixels

MAX_SIDE = 2048
"""Longer pictures are scaled down: no model is shown more."""

_JPEG = {"quality": 95, "subsampling": 0, "optimize": False}


def clean_copy(path: Path, max_side: int | None = MAX_SIDE) -> Image:
    """The pixels of a photo and nothing else: no place, time, owner, thumbnail. Raises ``PictureError``."""
    start = first_bytes(path)
    if is_heic(start):
        pixels = heic_pixels(path)
        return as_jpeg(pixels if max_side is None else scaled(pixels, max_side))
    pixels = load_picture(path, max_side)
    return Image.from_pixels(pixels) if start.startswith(PNG_START) else as_jpeg(pixels)


def first_bytes(path: Path) -> bytes:
    """The first bytes of a file; none of one that cannot be read."""
    try:
        with path.open("rb") as file:
            return file.read(12)
    except OSError:
        return b""


def scaled(pixels: Pixels, max_side: int) -> Pixels:
    """``pixels``, scaled down until no side is longer than ``max_side``."""
    height, width = pixels.shape[:2]
    if max(height, width) <= max_side:
        return pixels
    scale = max_side / max(height, width)
    size = max(1, round(width * scale)), max(1, round(height * scale))
    return np.asarray(PIL.Image.fromarray(pixels).resize(size, PIL.Image.Resampling.LANCZOS), dtype=np.uint8)


def as_jpeg(pixels: Pixels) -> Image:
    """A JPEG of high quality: a tenth of the size of a PNG of the same photo."""
    buffer = io.BytesIO()
    PIL.Image.fromarray(pixels).save(buffer, "JPEG", **_JPEG)
    return Image(buffer.getvalue())
