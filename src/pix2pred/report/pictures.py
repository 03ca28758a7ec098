"""Pictures as a page embeds them: each once, small, as WebP in a data URI."""

from __future__ import annotations

import base64
import io
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import PIL.Image

from pix2pred.structs.states import Image, PictureError
from pix2pred.system.files import write_whole

LONGEST_SIDE = 512
"""Pixels; what a model is shown at most."""

QUALITY = 86
"""WebP quality: a sixth of the lossless size, no difference that decides a label."""

PREVIEWS = "previews"
"""Folder of a run that keeps the reduced pictures, as making them takes longer than all the rest."""


class Album:
    """Numbers for pictures, in the order in which they are first asked for."""

    def __init__(self, folder: Path, blobs: Sequence[Path]) -> None:
        self._previews = folder / PREVIEWS
        self._blobs = blobs
        self._numbers: dict[str, int] = {}

    def number(self, digest: str) -> int:
        """The number of the picture with these pixels."""
        return self._numbers.setdefault(digest, len(self._numbers))

    def uris(self) -> list[str | None]:
        """A data URI per number; None for pictures that the run does not have."""
        with ThreadPoolExecutor(os.cpu_count()) as threads:
            return list(threads.map(self._uri, self._numbers))

    def _uri(self, digest: str) -> str | None:
        kept = self._previews / f"{digest}.webp"
        if not kept.exists():
            files = [blobs / f"{digest}.png" for blobs in self._blobs]
            image = Image(next((f for f in files if f.exists()), files[0]))
            try:
                write_whole(kept, image.alone(lambda: _preview(image)))
            except PictureError:
                return None
        return "data:image/webp;base64," + base64.b64encode(kept.read_bytes()).decode()


def _preview(image: Image) -> bytes:
    picture = PIL.Image.fromarray(image.pixels())
    picture.thumbnail((LONGEST_SIDE, LONGEST_SIDE), PIL.Image.Resampling.HAMMING)
    buffer = io.BytesIO()
    picture.save(buffer, "WEBP", quality=QUALITY, method=2)
    return buffer.getvalue()
