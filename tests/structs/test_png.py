"""Our PNG files: whole pictures, strips joined later, with and without the fast packing."""

from __future__ import annotations

import io
import runpy
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pix2pred.system.png
from pix2pred.structs import Image, PictureError
from pix2pred.system.png import pack, png_file, unpack


@pytest.mark.parametrize("size", [(1, 1), (1, 7), (9, 1), (30, 41)])
@pytest.mark.parametrize("cut", [0, 1, 8])
def test_packed_strips_make_up_the_picture(size: tuple[int, int], cut: int) -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (*size, 3), dtype=np.uint8)
    strips = [pack(part) for part in (pixels[:cut], pixels[cut:]) if len(part)]
    assert np.array_equal(Image(png_file(strips)).pixels(), pixels)


@given(st.lists(st.integers(1, 9), min_size=1, max_size=4), st.integers(1, 9), st.integers(0, 200))
def test_the_checksum_of_joined_strips_is_that_of_their_rows(heights: list[int], width: int, grey: int) -> None:
    strips = [pack(np.full((height, width, 3), grey + height, dtype=np.uint8)) for height in heights]
    file = png_file(strips)
    packed = file[file.index(b"IDAT") + 4 : file.index(b"IEND") - 8]
    assert len(zlib.decompress(packed)) == sum(strip.length for strip in strips), "zlib checks the sum"


@pytest.mark.parametrize("seed", range(8))
def test_without_fast_packing_the_bytes_are_the_same(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zlib_ng", None)
    plain = runpy.run_path(str(Path(pix2pred.system.png.__file__)), run_name="without")
    assert plain["packing"] is plain["unpacking"] is zlib
    assert zlib not in (vars(pix2pred.system.png)[module] for module in ("packing", "unpacking"))
    rng = np.random.default_rng(seed)
    size = tuple(rng.integers(1, 400, 2))
    noise = rng.integers(0, 256, (*size, 3), dtype=np.uint8)
    pixels = np.where(rng.random((*size, 1)) < rng.random(), noise, noise[:1, :1])
    assert plain["png_file"]([plain["pack"](pixels)]) == png_file([pack(pixels)])
    assert np.array_equal(plain["unpack"](png_file([pack(pixels)]), pixels.size), pixels)


def test_the_same_pixels_are_the_same_bytes_in_every_process() -> None:
    program = (
        "import hashlib, numpy as np; from pix2pred.system.png import pack;"
        "y, x = np.mgrid[:400, :500];"
        "pixels = np.stack([x // 7 * y // 9, x // 5, y // 3], 2).astype(np.uint8);"
        "print(hashlib.sha256(pack(pixels).blocks).hexdigest())"
    )
    runs = [subprocess.run([sys.executable, "-c", program], capture_output=True, text=True) for _ in range(4)]
    assert len({run.stdout for run in runs}) == 1 and runs[0].stdout, runs[0].stderr


PIXELS = np.random.default_rng(0).integers(0, 256, (7, 9, 3), dtype=np.uint8)
FILE = png_file([pack(PIXELS)])


def test_own_files_are_read_as_others_read_them() -> None:
    read = unpack(FILE, 63)
    assert read is not None and np.array_equal(read, PIXELS)
    assert np.array_equal(np.asarray(PIL.Image.open(io.BytesIO(FILE))), PIXELS)
    assert unpack(FILE, 62) is None, "more pixels than allowed"


@given(st.integers(0, len(FILE) - 1), st.integers(1, 255))
def test_a_damaged_file_is_never_read(place: int, change: int) -> None:
    damaged = bytes([*FILE[:place], FILE[place] ^ change, *FILE[place + 1 :]])
    assert unpack(damaged, 10**6) is None
    assert unpack(FILE[:place], 10**6) is None


@pytest.mark.parametrize("rows", [6, 8, 100_000])
def test_more_or_fewer_rows_than_promised_are_not_read(rows: int) -> None:
    strip = pack(np.zeros((rows, 9, 3), dtype=np.uint8))
    lying = png_file([strip]).replace(rows.to_bytes(4), (7).to_bytes(4), 1)
    header = lying[12:29]
    lying = lying.replace(lying[29:33], zlib.crc32(header).to_bytes(4), 1)
    assert unpack(lying, 63) is None


@pytest.mark.parametrize("level", [0, 1, 9])
def test_files_of_other_programs_are_left_to_a_general_decoder(level: int) -> None:
    buffer = io.BytesIO()
    PIL.Image.fromarray(PIXELS).save(buffer, "PNG", compress_level=level)
    assert unpack(buffer.getvalue(), 63) is None and np.array_equal(Image(buffer.getvalue()).pixels(), PIXELS)


def test_what_is_no_picture_is_named(tmp_path: Path) -> None:
    with pytest.raises(PictureError, match=r"nothing.png"):
        Image(tmp_path / "nothing.png").pixels()
    with pytest.raises(PictureError):
        Image(FILE[:60]).pixels()
