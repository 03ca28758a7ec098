"""Pictures are their pixels; demonstrations have one more state than actions."""

from __future__ import annotations

import io
import pickle
import warnings
import zlib
from pathlib import Path

import numpy as np
import PIL.ExifTags
import PIL.Image
import PIL.PngImagePlugin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.structs import Box, Demo, Image, Picture, PictureError, Pixels, State


def pixels(seed: int, height: int = 7, width: int = 9) -> Pixels:
    return np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)


def encoded(array: Pixels, format: str = "PNG", **options: object) -> bytes:
    buffer = io.BytesIO()
    PIL.Image.fromarray(array).save(buffer, format, **options)
    return buffer.getvalue()


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 100), height=st.integers(1, 20), width=st.integers(1, 20), level=st.integers(0, 9))
def test_compression_does_not_matter(seed: int, height: int, width: int, level: int) -> None:
    array = pixels(seed, height, width)
    one, other = Image.from_pixels(array), Image(encoded(array, compress_level=level))
    assert one == other
    assert hash(one) == hash(other)
    assert one.digest == Image(one.encoded).digest
    assert np.array_equal(other.pixels(), array)


def test_metadata_does_not_matter() -> None:
    info = PIL.PngImagePlugin.PngInfo()
    info.add_text("secret", "the patty is cooked")
    assert encoded(pixels(1), pnginfo=info) != encoded(pixels(1))
    assert Image(encoded(pixels(1), pnginfo=info)) == Image(encoded(pixels(1)))


def test_the_place_of_the_file_does_not_matter(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(encoded(pixels(1)))
    assert Image(tmp_path / "a.png") == Image.from_pixels(pixels(1))


def test_pixels_and_shape_do_matter() -> None:
    changed = pixels(1)
    changed[0, 0, 0] ^= 1
    assert Image.from_pixels(changed) != Image.from_pixels(pixels(1))
    flat = np.zeros((2, 8, 3), np.uint8)
    assert Image.from_pixels(flat) != Image.from_pixels(flat.reshape(4, 4, 3))
    assert Image.from_pixels(flat) != flat.tobytes()


def test_grey_and_transparent_pictures_become_rgb() -> None:
    for mode in ("L", "RGBA", "P", "1"):
        buffer = io.BytesIO()
        PIL.Image.new(mode, (3, 2)).save(buffer, "PNG")
        assert Image(buffer.getvalue()).pixels().shape == (2, 3, 3)


@pytest.mark.parametrize("content", [b"", b"junk", encoded(pixels(1))[:45], b"\xff\xd8\xff\xe0junk"])
def test_what_is_no_picture_is_a_picture_error(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.png").write_bytes(content)
    with pytest.raises(PictureError, match=r"a\.png"):
        Image(tmp_path / "a.png").pixels()
    with pytest.raises(PictureError, match="picture"):
        Image(content).pixels()


def test_a_missing_file_is_a_picture_error(tmp_path: Path) -> None:
    with pytest.raises(PictureError, match="missing"):
        Image(tmp_path / "missing.png").pixels()


@pytest.mark.parametrize("width", [65_000, 100_000, 1_000_000, 100_000_000])
def test_decompression_bombs_are_picture_errors(width: int) -> None:
    small = encoded(np.zeros((1000, 1, 3), np.uint8))
    size = width.to_bytes(4, "big")
    header = b"IHDR" + size + small[20:29]
    bomb = small[:12] + header + zlib.crc32(header).to_bytes(4, "big") + small[33:]
    with warnings.catch_warnings(), pytest.raises(PictureError):
        warnings.simplefilter("error")
        Image(bomb).pixels()
    with pytest.raises(PictureError, match=str(width)):
        _ = Image(bomb).size


@pytest.mark.parametrize("format", ["BMP", "GIF", "TIFF", "WEBP", "PPM", "ICO"])
def test_other_formats_are_picture_errors(format: str) -> None:
    buffer = io.BytesIO()
    PIL.Image.fromarray(pixels(1)).save(buffer, format)
    with pytest.raises(PictureError, match="neither PNG nor JPEG"):
        Image(buffer.getvalue()).pixels()


def photo(orientation: object, format: str = "PNG") -> bytes:
    exif = PIL.Image.Exif()
    exif[PIL.ExifTags.Base.Orientation] = orientation
    return encoded(pixels(1), format, exif=exif)


@pytest.mark.parametrize("format", ["PNG", "JPEG"])
@pytest.mark.parametrize("orientation", range(10))
def test_photos_are_upright_and_their_size_too(orientation: int, format: str) -> None:
    image = Image(photo(orientation, format))
    assert image.size == image.pixels().shape[1::-1]
    assert image.size == ((7, 9) if 5 <= orientation <= 8 else (9, 7))


def test_the_eight_orientations_turn_and_mirror() -> None:
    upright = pixels(1)
    for orientation, seen in {3: upright[::-1, ::-1], 6: np.rot90(upright, -1), 8: np.rot90(upright)}.items():
        assert np.array_equal(Image(photo(orientation)).pixels(), seen)
    assert len({Image(photo(orientation)).digest for orientation in range(1, 9)}) == 8
    assert Image(photo(1)) == Image(encoded(upright))


@pytest.mark.filterwarnings("ignore:Corrupt EXIF")
def test_a_damaged_orientation_is_a_picture_error_or_none() -> None:
    for junk in (b"Exif\0\0junk", b"Exif\0\0II*\0\xff\xff\xff\xff", b"Exif\0\0MM\0*\0\0\0\x08\xff\xff"):
        try:
            assert Image(encoded(pixels(1), "JPEG", exif=junk)).size == (9, 7)
        except PictureError as error:
            assert str(error)


def test_the_size_of_a_photo_is_known_before_it_is_decoded() -> None:
    large = encoded(np.zeros((500, 700, 3), np.uint8), "JPEG")
    assert Image(large[:900]).size == (700, 500)
    assert "size" in vars(Image.from_pixels(pixels(1)))
    assert Image.from_pixels(pixels(1)).size == (9, 7)


@settings(max_examples=60, deadline=None)
@given(st.binary(max_size=60), st.integers(0, 250), st.sampled_from(["PNG", "JPEG"]))
def test_damaged_pictures_decode_or_are_picture_errors(junk: bytes, at: int, format: str) -> None:
    whole = encoded(pixels(1), format)
    try:
        Image(whole[:at] + junk + whole[at + len(junk) :]).pixels()
    except PictureError as error:
        assert str(error)


def test_states_and_pictures_pickle() -> None:
    state = State((Picture("main", Image.from_pixels(pixels(1)), {"a": Box(0, 0, 1, 1)}),), given=frozenset())
    for thing in (state, State(), Picture("main", Image.from_pixels(pixels(1)))):
        assert pickle.loads(pickle.dumps(thing)) == thing


def test_boxes() -> None:
    box = Box(1, 2, 4, 8)
    assert (box.width, box.height, box.center) == (3, 6, (2.5, 5))
    assert box.union(Box(0, 3, 2, 9)) == Box(0, 2, 4, 9)


def test_a_demo_has_one_more_state_than_actions() -> None:
    Demo("d", (), (State(),), (), ())
    with pytest.raises(ValueError, match="0 actions need 1 states, found 2"):
        Demo("d", (), (State(), State()), (), ())


def test_grey_of_sixteen_bits_keeps_its_shades() -> None:
    ramp = np.linspace(0, 65535, 256).astype(np.uint16).reshape(16, 16)
    buffer = io.BytesIO()
    PIL.Image.fromarray(ramp).save(buffer, "PNG")
    pixels = Image(buffer.getvalue()).pixels()
    assert pixels.shape == (16, 16, 3)
    assert np.array_equal(pixels[:, :, 0].ravel(), np.arange(256)) and np.ptp(pixels, axis=2).max() == 0
