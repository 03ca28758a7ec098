"""Views as PNG files. What is costly about them is kept for a while, since pictures are shown several times.

A state is shown whole and cropped, after one skill and before the next, and again for the double check.
"""

from __future__ import annotations

import json
import threading
from collections import OrderedDict
from collections.abc import Callable
from functools import lru_cache
from typing import Generic, TypeVar

from pix2pred.images.draw import draw_heading, draw_note, draw_scene
from pix2pred.structs import Image, Pixels
from pix2pred.structs.views import View
from pix2pred.system.png import Strip, pack, png_file

_PACKED_BYTES = 64_000_000
_DECODED_BYTES = 96_000_000

Kept = TypeVar("Kept")


class ShownPictures:
    """Draws and encodes views, losslessly. May be called from several threads."""

    def __init__(self, packed_bytes: int = _PACKED_BYTES, decoded_bytes: int = _DECODED_BYTES) -> None:
        self._packed = _Latest[Strip](packed_bytes, lambda strip: len(strip.blocks))
        self._decoded = _Latest[Pixels](decoded_bytes, lambda pixels: pixels.nbytes)

    def __call__(self, view: View) -> bytes:
        """The PNG file of the view."""
        shown = {name: value for name, value in view.canonical().items() if name not in ("heading", "state")}
        scene = self._packed.get(json.dumps(shown, sort_keys=True), lambda: self._scene(view))
        above = [_packed(draw_heading, view.heading, scene.width)] if view.heading else []
        return png_file([*above, scene, *(_packed(draw_note, row, scene.width) for row in view.note_rows)])

    def _scene(self, view: View) -> Strip:
        return view.picture.image.alone(lambda: pack(draw_scene(view, decode=self._decode)))

    def _decode(self, image: Image) -> Pixels:
        return self._decoded.get(image.digest, image.pixels)


@lru_cache(maxsize=1024)
def _packed(draw: Callable[[str, int], Pixels], text: str, width: int) -> Strip:
    """A strip of text: the same headings stand above many pictures."""
    return pack(draw(text, width))


class _Latest(Generic[Kept]):
    """The values used last, as many as fit into ``most_bytes``."""

    def __init__(self, most_bytes: int, size: Callable[[Kept], int]) -> None:
        self._most_bytes = most_bytes
        self._size = size
        self._values: OrderedDict[str, Kept] = OrderedDict()
        self._bytes = 0
        self._lock = threading.Lock()
        self._making: dict[str, threading.Lock] = {}

    def get(self, key: str, make: Callable[[], Kept]) -> Kept:
        """The value kept under ``key``, or a new one; who asks while it is made, waits for it."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
                return self._values[key]
            making = self._making.setdefault(key, threading.Lock())
        with making:
            with self._lock:
                if key in self._values:
                    return self._values[key]
            try:
                return self._keep(key, make())
            finally:
                self._making.pop(key, None)

    def _keep(self, key: str, value: Kept) -> Kept:
        with self._lock:
            if key not in self._values:
                self._values[key] = value
                self._bytes += self._size(value)
            while self._bytes > self._most_bytes:
                _, oldest = self._values.popitem(last=False)
                self._bytes -= self._size(oldest)
        return value
