"""Pictures as they may be given to others: pixels and nothing else."""

from __future__ import annotations

import io
from dataclasses import replace

import PIL.Image

from pix2pred.demos.photos.copies import as_jpeg
from pix2pred.demos.pictures import JPEG_START
from pix2pred.structs import Demo, Image, State, Task

_HARMLESS = {"jfif", "jfif_version", "jfif_unit", "jfif_density", "dpi", "gamma", "srgb", "interlace", "progressive",
             "progression"}  # fmt: skip
"""What decoders tell about a file that says nothing about where, when or by whom it was made."""


def bare_demo(demo: Demo) -> Demo:
    """The demonstration with pictures that hold no place, time, owner, comment or thumbnail."""
    return replace(demo, states=tuple(map(_bare_state, demo.states)))


def bare_task(task: Task) -> Task:
    """The task with such pictures."""
    return replace(task, initial=_bare_state(task.initial))


def _bare_state(state: State) -> State:
    pictures = (replace(p, image=bare(p.image)) for p in state.pictures)
    return replace(state, pictures=tuple(pictures))


def bare(image: Image) -> Image:
    """The same pixels without anything beside them; a file that holds nothing else is kept byte for byte."""
    encoded = image.encoded
    with PIL.Image.open(io.BytesIO(encoded)) as opened:
        opened.load()
        if not opened.getexif() and set(opened.info) <= _HARMLESS:
            return image
    pixels = image.pixels()
    return as_jpeg(pixels) if encoded.startswith(JPEG_START) else Image.from_pixels(pixels)
