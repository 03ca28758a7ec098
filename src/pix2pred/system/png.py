"""Writing and reading PNG files fast: one filter for all rows, where Pillow tries five a row, and runs alone packed.

Most pictures are decoded once or twice; a twentieth of the size matters less than most of the time. Runs are packed
into the same bytes by zlib and by zlib-ng, which takes half the time; tests compare them. ISA-L unpacks in a third of
the time of either; it does not pack, since in one process of fifty the same pixels become other bytes.
Strips of a picture are packed apart and joined later, so that a picture shown under several headings is packed once.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

try:
    from isal import isal_zlib as unpacking
    from zlib_ng import zlib_ng as packing
except ImportError:  # no wheels for this kind of machine: the same bytes and pixels, more slowly
    import zlib as packing  # type: ignore[no-redef]
    import zlib as unpacking  # type: ignore[no-redef]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_RGB8 = (8, 2, 0, 0, 0)
_SUB = 1
"""Filter type: every byte less the one of the pixel to its left (PNG specification, section 9)."""
_CONTENT = 41
"""Where the packed rows begin, behind signature, header and the head of their chunk; 16 bytes follow them."""
_HEADER, _LAST_BLOCK = b"\x78\x01", b"\x03\x00"
"""How a zlib stream begins, and the empty block that ends it (RFC 1950, RFC 1951)."""
_BASE = 65521
"""Modulus of Adler-32 (RFC 1950)."""


@dataclass(frozen=True, slots=True)
class Strip:
    """Packed rows of a picture of ``width`` x ``height`` pixels.

    ``blocks`` are whole deflate blocks, ``adler`` is the Adler-32 sum of the ``length`` bytes in them.
    """

    width: int
    height: int
    blocks: bytes
    adler: int

    @property
    def length(self) -> int:
        """Bytes before packing: three a pixel, and one a row for the filter."""
        return self.height * (1 + 3 * self.width)


def pack(pixels: NDArray[np.uint8]) -> Strip:
    """The rows of an RGB picture, shape (height, width, 3)."""
    height, width = pixels.shape[:2]
    rows = np.empty((height, 1 + 3 * width), dtype=np.uint8)
    flat = pixels.reshape(height, 3 * width)
    rows[:, 0] = _SUB
    rows[:, 1:4] = flat[:, :3]
    np.subtract(flat[:, 3:], flat[:, :-3], out=rows[:, 4:])  # wraps around, as the format asks
    packer = packing.compressobj(1, packing.DEFLATED, -15, 9, packing.Z_RLE)
    blocks = packer.compress(rows.data) + packer.flush(packing.Z_FULL_FLUSH)
    return Strip(width, height, blocks, packing.adler32(rows))


def png_file(strips: Sequence[Strip]) -> bytes:
    """The PNG file of strips of one width, from top to bottom."""
    low, high = 1, 0
    for strip in strips:
        assert strip.width == strips[0].width, "strips of one picture have one width"
        high = (high + (strip.adler >> 16) + strip.length * (low - 1)) % _BASE
        low = (low + (strip.adler & 0xFFFF) - 1) % _BASE
    packed = (_HEADER, *(s.blocks for s in strips), _LAST_BLOCK, struct.pack(">I", high << 16 | low))
    return _file(strips[0].width, sum(s.height for s in strips), packed)


def unpack(encoded: bytes, most_pixels: int) -> NDArray[np.uint8] | None:
    """The picture in a file that ``png_file`` wrote, shape (height, width, 3), in a third of the time Pillow takes.

    ``None`` for every other file, damaged ones and those of more than ``most_pixels``: a general decoder tells more.
    """
    width, height = (int.from_bytes(encoded[place : place + 4]) for place in (16, 20))
    length = height * (1 + 3 * width)
    content = encoded[_CONTENT : len(encoded) - 16]
    if not 0 < width * height <= most_pixels or encoded != _file(width, height, (content,)):
        return None
    try:
        inflate = unpacking.decompressobj()
        data = inflate.decompress(content, length + 1)
    except unpacking.error:  # type: ignore[misc]
        return None
    if len(data) != length or not inflate.eof or inflate.unused_data:
        return None
    rows = np.frombuffer(data, dtype=np.uint8).reshape(height, 1 + 3 * width)
    if not (rows[:, 0] == _SUB).all():
        return None
    return np.cumsum(rows[:, 1:].reshape(height, width, 3), axis=1, dtype=np.uint8)


def _file(width: int, height: int, content: Sequence[bytes]) -> bytes:
    header = struct.pack(">IIBBBBB", width, height, *_RGB8)
    return b"".join((_SIGNATURE, *_chunk(b"IHDR", header), *_chunk(b"IDAT", *content), *_chunk(b"IEND")))


def _chunk(kind: bytes, *content: bytes) -> tuple[bytes, ...]:
    check = packing.crc32(kind)
    for piece in content:
        check = packing.crc32(piece, check)
    return struct.pack(">I", sum(map(len, content))), kind, *content, struct.pack(">I", check)
