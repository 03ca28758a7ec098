"""What a state looks like: pictures with boxes, optional features, given atoms (method 1.2)."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from pix2pred.structs.objects import Object
from pix2pred.structs.predicates import Atom

Pixels = NDArray[np.uint8]
"""An RGB picture, shape (height, width, 3)."""

MAX_PIXELS = 64_000_000
"""Larger pictures are refused: no camera in the field makes them, decompression bombs do."""


class PictureError(ValueError):
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
        buffer = io.BytesIO()
        PIL.Image.fromarray(pixels).save(buffer, "PNG", compress_level=1)
        image = cls(buffer.getvalue())
        image.__dict__["digest"] = _digest(pixels)
        return image

    @property
    def encoded(self) -> bytes:
        """The file's bytes."""
        return self._source if isinstance(self._source, bytes) else self._source.read_bytes()

    def pixels(self) -> Pixels:
        """Decode. Raises ``PictureError`` for what is not a picture of a sane size."""
        name = self._source if isinstance(self._source, Path) else "picture"
        try:
            with PIL.Image.open(io.BytesIO(self.encoded)) as opened:
                if opened.width * opened.height > MAX_PIXELS:
                    raise PictureError(
                        f"{name}: {opened.width}x{opened.height} pixels is more than {MAX_PIXELS}; scale it down"
                    )
                return np.asarray(opened.convert("RGB"), dtype=np.uint8)
        except PictureError:
            raise
        except (OSError, ValueError, SyntaxError, PIL.Image.DecompressionBombError) as error:
            raise PictureError(f"{name}: cannot be read as a picture ({error})") from error

    @cached_property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        height, width = self.pixels().shape[:2]
        return width, height

    @cached_property
    def digest(self) -> str:
        """SHA-256 of shape and decoded pixels: the same whatever compressed the file."""
        return _digest(self.pixels())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Image) and self.digest == other.digest

    def __hash__(self) -> int:
        return int(self.digest[:15], 16)


def _digest(pixels: Pixels) -> str:
    height, width = pixels.shape[:2]
    return hashlib.sha256(f"rgb8:{width}x{height}:".encode() + np.ascontiguousarray(pixels).tobytes()).hexdigest()


@dataclass(frozen=True, slots=True)
class Picture:
    """One camera's clean view of a state, with the boxes of the objects a detector located in it."""

    camera: str
    image: Image
    boxes: Mapping[str, Box] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, slots=True)
class State:
    """Pictures (one per camera, same order in every state), object features, and the given atoms known to hold.

    ``features`` maps an object to values in the order of its type's feature names; it is empty for data
    that has none, such as photos. Hidden simulator state never appears here.
    """

    pictures: tuple[Picture, ...] = ()
    features: Mapping[Object, tuple[float, ...]] = field(default_factory=lambda: MappingProxyType({}))
    given: frozenset[Atom] = frozenset()


AbstractState = frozenset[Atom]
"""All atoms that hold; whatever is absent is false."""
