"""Writing PNG files fast: one filter for all rows and run-length coding, where Pillow tries five filters a row.

The pictures sent to a model are looked at once; a tenth of the size matters less than a fifth of the time.
"""

from __future__ import annotations

import struct
import zlib

import numpy as np

from pix2pred.structs import Pixels

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_RGB8 = (8, 2, 0, 0, 0)
_UP = 2
"""Filter type: every byte less the one above it (PNG specification, section 9)."""


def fast_png(pixels: Pixels) -> bytes:
    """The PNG file of an array of shape (height, width, 3)."""
    height, width = pixels.shape[:2]
    rows = np.empty((height, 1 + 3 * width), dtype=np.uint8)
    flat = pixels.reshape(height, 3 * width)
    rows[:, 0] = _UP
    rows[0, 1:] = flat[0]
    np.subtract(flat[1:], flat[:-1], out=rows[1:, 1:])  # wraps around, as the format asks
    deflate = zlib.compressobj(1, zlib.DEFLATED, 15, 9, zlib.Z_RLE)
    data = deflate.compress(rows.tobytes()) + deflate.flush()
    header = struct.pack(">IIBBBBB", width, height, *_RGB8)
    return _SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", data) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
