"""Photos as iPhones keep them (HEIC), for import alone: a project holds PNG and JPEG. Needs the extra ``heic``."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from pix2pred.demos.pictures import MAX_BYTES
from pix2pred.structs import PictureError, Pixels
from pix2pred.structs.states import MAX_PIXELS, rgb_pixels
from pix2pred.system.extras import MissingExtraError, optional

_ONE = threading.Lock()
"""Such photos are unpacked one at a time, by a library with threads of its own: many have 48 million pixels."""

HEIC_ENDINGS = (".heic", ".heif")
_BRANDS = (b"heic", b"heix", b"heim", b"heis", b"mif1", b"msf1")
"""What stands behind ``ftyp`` at the beginning of such a file, whatever its name says."""


def is_heic(start: bytes) -> bool:
    """Whether a file that begins with the twelve bytes ``start`` is one."""
    return start[4:8] == b"ftyp" and start[8:12] in _BRANDS


def open_heic(path: Path) -> Any:
    """The photo as Pillow has it, upright, before decoding. Raises ``PictureError``; its message names the extra."""
    try:
        library = optional("pi_heif", "heic")
    except MissingExtraError as error:
        raise PictureError(
            f"{path}: is a HEIC photo, and {error}; or export it as JPEG (an iPhone takes JPEG with Settings > "
            "Camera > Formats > Most Compatible)"
        ) from error
    if path.stat().st_size > MAX_BYTES:
        raise PictureError(f"{path}: has more than {MAX_BYTES} bytes, which are not read")
    try:
        opened = library.HeifImageFile(path)
    except Exception as error:  # the decoder fails in many ways on damaged files
        raise PictureError(f"{path}: cannot be read as a picture ({error})") from error
    if opened.width * opened.height > MAX_PIXELS:
        raise PictureError(f"{path}: {opened.width}x{opened.height} pixels is more than {MAX_PIXELS}; scale it down")
    return opened


def heic_pixels(path: Path) -> Pixels:
    """The pixels of a HEIC photo, upright. Raises ``PictureError``."""
    with _ONE, open_heic(path) as opened:
        try:
            opened.load()
            return rgb_pixels(opened)
        except Exception as error:
            raise PictureError(f"{path}: cannot be read as a picture ({error})") from error
