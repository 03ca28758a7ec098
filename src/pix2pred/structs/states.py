"""What a state looks like: pictures with boxes, optional features, given atoms (method 1.2)."""

from __future__ import annotations

import hashlib
import io
import os
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import TypeVar

import numpy as np
import PIL.ExifTags
import PIL.Image
import PIL.ImageOps
from numpy.typing import NDArray
from PIL.JpegImagePlugin import JpegImageFile
from PIL.PngImagePlugin import PngImageFile

from pix2pred.structs.objects import Object
from pix2pred.structs.predicates import Atom
from pix2pred.system.errors import Pix2predError
from pix2pred.system.png import pack, png_file, unpack

Pixels = NDArray[np.uint8]
"""An RGB picture, shape (height, width, 3)."""

MAX_PIXELS = 64_000_000
"""Larger pictures are refused: no camera in the field makes them, decompression bombs do."""


LARGE_PIXELS = 12_000_000
"""Larger pictures are unpacked one at a time: while that lasts, each takes up to twelve bytes a pixel."""

_LARGE = "pix2pred-large-picture"
"""Beginning of the name of the thread that works on large pictures."""

Made = TypeVar("Made")


@cache
def _worker() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, _LARGE)


if hasattr(os, "register_at_fork"):  # threads do not live on in a fork
    os.register_at_fork(after_in_child=_worker.cache_clear)

_SPARE = 1.5
"""How much larger a JPEG is at least unpacked than it is wanted, so that scaling it down loses nothing to be seen."""

_DECODERS = {b"\x89PNG\r\n\x1a\n": PngImageFile, b"\xff\xd8\xff": JpegImageFile}
"""The formats read, by their first bytes. ``PIL.Image.open`` would warn of large pictures before we know their size."""

_TURNED_PNG = (b"eXIf", b"Raw profile type exif", b"tiff:Orientation")
"""What stands in every PNG that says how it is to be turned."""
_ROWS = 512
"""Rows of a picture that are copied at a time."""

_SIDEWAYS = frozenset({5, 6, 7, 8})
"""EXIF orientations that swap width and height."""


class PictureError(Pix2predError, ValueError):
    """A picture could not be read; the message says which and why."""


@dataclass(frozen=True, slots=True)
class Box:
    """Where an object is in a picture, in pixels; ``right`` and ``bottom`` are exclusive."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def width(self) -> float:
        """Extent in x."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Extent in y."""
        return self.bottom - self.top

    @property
    def center(self) -> tuple[float, float]:
        """The middle, (x, y)."""
        return (self.left + self.right) / 2, (self.top + self.bottom) / 2

    @classmethod
    def around(cls, mask: NDArray[np.bool_]) -> Box:
        """The box around the true pixels of ``mask``, of shape (height, width); there are some."""
        rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
        return cls(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))

    def union(self, other: Box) -> Box:
        """The smallest box that covers both."""
        return Box(
            min(self.left, other.left), min(self.top, other.top),
            max(self.right, other.right), max(self.bottom, other.bottom),
        )  # fmt: skip


class Image:
    """An encoded picture, decoded when asked for. Two images are equal when their pixels are.

    Pixels are not kept after decoding: demonstrations with many cameras would not fit in memory.
    """

    def __init__(self, source: Path | bytes) -> None:
        self._source = source

    @classmethod
    def from_pixels(cls, pixels: Pixels) -> Image:
        """An image of an array of shape (height, width, 3), encoded as PNG."""
        image = cls(png_file([pack(pixels)]))
        image.__dict__ |= {"digest": _digest(pixels), "size": (pixels.shape[1], pixels.shape[0])}
        return image

    @property
    def encoded(self) -> bytes:
        """The file's bytes."""
        return self._source if isinstance(self._source, bytes) else self._source.read_bytes()

    def pixels(self) -> Pixels:
        """Decode, upright. Raises ``PictureError`` for what is not a PNG or JPEG picture of a sane size."""
        pixels = self.alone(self._decoded)
        if isinstance(self._source, bytes):
            return pixels
        if self.__dict__.setdefault("digest", digest := _digest(pixels)) != digest:
            raise PictureError(f"{self._source!s:.200}: changed while it was being used; run the command again")
        return pixels

    def _decoded(self) -> Pixels:
        pixels = self._unpacked()
        if pixels is None:
            with self._opened() as opened:
                pixels = _upright(opened)
        return pixels

    def reduced(self, longest: int) -> Pixels:
        """Upright, scaled down until no side is longer than ``longest``. Of a larger JPEG, less is ever unpacked.

        Raises ``PictureError``.
        """
        width, height = self.size
        factor = longest / max(width, height)
        if factor >= 1:
            return self.pixels()
        return self.alone(lambda: self._scaled(factor, (max(1, round(width * factor)), max(1, round(height * factor)))))

    def _scaled(self, factor: float, size: tuple[int, int]) -> Pixels:
        with self._opened() as opened:
            least = round(_SPARE * factor * opened.width), round(_SPARE * factor * opened.height)
            opened.draft("RGB", (max(1, least[0]), max(1, least[1])))
            whole = PIL.Image.fromarray(_upright(opened))
            return np.asarray(whole.resize(size, PIL.Image.Resampling.LANCZOS), dtype=np.uint8)

    def alone(self, work: Callable[[], Made]) -> Made:
        """What ``work`` gives. Work on a picture of more than ``LARGE_PIXELS`` is done one at a time, in one thread.

        Memory that a thread gave back serves no other: eight threads, each with its turn, would hold eight pictures.
        """
        if self.size[0] * self.size[1] <= LARGE_PIXELS or threading.current_thread().name.startswith(_LARGE):
            return work()
        return _worker().submit(work).result()

    @cached_property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels, upright. Raises ``PictureError``."""
        with self._opened() as opened:
            width, height = opened.size
            content = self.encoded
            if isinstance(opened, PngImageFile) and not any(mark in content for mark in _TURNED_PNG):
                return width, height  # to look for EXIF data in a PNG, Pillow unpacks all of it
            sideways = opened.getexif().get(PIL.ExifTags.Base.Orientation) in _SIDEWAYS
            return (height, width) if sideways else (width, height)

    def _unpacked(self) -> Pixels | None:
        try:
            return unpack(self.encoded, MAX_PIXELS)
        except OSError:
            return None

    @contextmanager
    def _opened(self) -> Iterator[PIL.Image.Image]:
        """The picture before decoding; whatever goes wrong with it is a ``PictureError``."""
        name = self._source if isinstance(self._source, Path) else "picture"
        try:
            content = self.encoded
            decoder = next((d for start, d in _DECODERS.items() if content.startswith(start)), None)
            if decoder is None:
                raise PictureError(f"{name}: cannot be read as a picture (neither PNG nor JPEG)")
            with decoder(io.BytesIO(content)) as opened:
                if opened.width * opened.height > MAX_PIXELS:
                    raise PictureError(
                        f"{name}: {opened.width}x{opened.height} pixels is more than {MAX_PIXELS}; scale it down"
                    )
                yield opened
        except PictureError:
            raise
        except Exception as error:  # the decoders fail in many ways on damaged files
            raise PictureError(f"{name}: cannot be read as a picture ({error})") from error

    @property
    def digest(self) -> str:
        """SHA-256 of shape and decoded pixels: the same whatever compressed the file."""
        if "digest" not in self.__dict__:  # no cached property: one lock for all pictures, in Python 3.11
            self.__dict__.setdefault("digest", _digest(self.pixels()))
        return str(self.__dict__["digest"])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Image) and self.digest == other.digest

    def __hash__(self) -> int:
        return int(self.digest[:15], 16)


def _upright(picture: PIL.Image.Image) -> Pixels:
    PIL.ImageOps.exif_transpose(picture, in_place=True)
    return rgb_pixels(picture)


def rgb_pixels(picture: PIL.Image.Image) -> Pixels:
    """The pixels of an opened picture, a few rows at a time so that no second whole one is held.

    Eight bits a channel; of 16-bit grey, which Pillow would clip to white, the upper eight.
    """
    if picture.mode.startswith("I"):
        grey = (np.asarray(picture).astype(np.int64) >> 8).clip(0, 255).astype(np.uint8)
        return np.repeat(grey[:, :, None], 3, axis=2)
    pixels = np.empty((picture.height, picture.width, 3), dtype=np.uint8)
    for top in range(0, picture.height, _ROWS):  # Pillow hands pixels over by way of two copies
        rows = picture.crop((0, top, picture.width, min(top + _ROWS, picture.height)))
        pixels[top : top + _ROWS] = np.asarray(rows if rows.mode == "RGB" else rows.convert("RGB"))
    return pixels


def _digest(pixels: Pixels) -> str:
    height, width = pixels.shape[:2]
    digest = hashlib.sha256(f"rgb8:{width}x{height}:".encode())
    digest.update(np.ascontiguousarray(pixels).data)
    return digest.hexdigest()


@dataclass(frozen=True, slots=True)
class Picture:
    """One camera's clean view of a state, with the boxes of the objects a detector located in it."""

    camera: str
    image: Image
    boxes: Mapping[str, Box] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class State:
    """Pictures (one per camera, same order in every state), object features, and the given atoms known to hold.

    ``features`` maps an object to values in the order of its type's feature names; it is empty for data
    that has none, such as photos. Hidden simulator state never appears here.
    """

    pictures: tuple[Picture, ...] = ()
    features: Mapping[Object, tuple[float, ...]] = field(default_factory=dict)
    given: frozenset[Atom] = frozenset()


AbstractState = frozenset[Atom]
"""All atoms that hold; whatever is absent is false."""
