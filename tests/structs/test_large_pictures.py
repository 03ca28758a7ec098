"""Large photos: what is unpacked of them, one at a time, and copies that show the same."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from pix2pred.demos.authoring import clean_copy
from pix2pred.structs import Image, PictureError, Pixels
from pix2pred.structs.states import LARGE_PIXELS
from pix2pred.structs.views import View


def large(path: Path, size: tuple[int, int] = (4400, 3300), orientation: int = 6) -> Path:
    """A photo taken sideways: red on the left, blue on the right, a white square in the upper left."""
    picture = PIL.Image.new("RGB", size, "red")
    picture.paste("blue", (size[0] // 2, 0, *size))
    picture.paste("white", (0, 0, size[1] // 4, size[1] // 4))
    exif = PIL.Image.Exif()
    exif[0x0112] = orientation
    picture.save(path, exif=exif, quality=90, compress_level=1)
    return path


@pytest.mark.parametrize("ending", ["jpg", "png"])
@pytest.mark.parametrize("orientation", [1, 3, 6])
def test_a_reduced_picture_shows_the_same(tmp_path: Path, ending: str, orientation: int) -> None:
    image = Image(large(tmp_path / f"x.{ending}", orientation=orientation))
    small = image.reduced(330)
    assert max(small.shape) == 330
    whole = PIL.Image.fromarray(image.pixels()).resize((small.shape[1], small.shape[0]), PIL.Image.Resampling.BOX)
    assert np.abs(np.asarray(whole).astype(int) - small).mean() < 1


def test_of_a_large_jpeg_less_is_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Less than a quarter of the pixels: 4400 x 3300 at a half or less, wanted at 512."""
    unpacked: list[tuple[int, ...]] = []
    kept = PIL.Image.fromarray

    def seen(pixels: Pixels) -> PIL.Image.Image:
        unpacked.append(pixels.shape)
        return kept(pixels)

    monkeypatch.setattr(PIL.Image, "fromarray", seen)
    Image(large(tmp_path / "x.jpg")).reduced(512)
    height, width, _ = unpacked[0]
    assert 512 <= max(height, width) <= 1100


@pytest.mark.parametrize("size", [(4400, 3300), (3300, 4400), (64, 48)])
def test_to_know_the_size_of_a_png_none_of_it_is_unpacked(tmp_path: Path, size: tuple[int, int]) -> None:
    """The pixels of this one are damaged, which nobody notices who does not look at them."""
    plain = tmp_path / "x.png"
    PIL.Image.new("RGB", size, "red").save(plain)
    content = plain.read_bytes()
    damaged = Image(content[: content.index(b"IDAT") + 4] + b"no pixels" + content[-40:])
    assert damaged.size == size
    with pytest.raises(PictureError):
        damaged.pixels()


def test_small_pictures_are_as_they_were(tmp_path: Path) -> None:
    image = Image(large(tmp_path / "x.jpg", (640, 480)))
    assert np.array_equal(image.reduced(640), image.pixels())
    assert clean_copy(tmp_path / "x.jpg").size == (480, 640)


def test_large_pictures_take_turns_and_small_ones_do_not_wait(tmp_path: Path) -> None:
    big, small = Image(large(tmp_path / "x.jpg")), Image(large(tmp_path / "y.jpg", (64, 48)))
    assert big.size[0] * big.size[1] > LARGE_PIXELS
    under_way, most, inside, go_on = 0, 0, threading.Event(), threading.Event()

    def work() -> int:
        nonlocal under_way, most
        under_way += 1
        most = max(most, under_way)
        inside.set()
        assert go_on.wait(120)
        assert big.alone(lambda: "within") == "within"
        assert len(big.digest) == 64
        under_way -= 1
        return 1

    with ThreadPoolExecutor(4) as threads:
        done = [threads.submit(big.alone, work) for _ in range(4)]
        digest = threads.submit(lambda: big.digest)
        assert inside.wait(120)
        assert small.alone(lambda: "meanwhile") == "meanwhile" and len(small.digest) == 64
        go_on.set()
        assert [d.result(120) for d in done] == [1] * 4 and digest.result(120) == big.digest
    assert most == 1


def test_what_goes_wrong_with_a_large_picture_reaches_the_caller(tmp_path: Path) -> None:
    path = large(tmp_path / "x.jpg")
    path.write_bytes(path.read_bytes()[:5000])
    for work in (Image(path).pixels, lambda: Image(path).reduced(500), lambda: Image(path).digest):
        with pytest.raises(PictureError, match=r"x\.jpg: cannot be read as a picture"):
            work()


def test_a_view_of_a_large_picture_is_drawn(tmp_path: Path) -> None:
    from pix2pred.images import ShownPictures
    from pix2pred.structs import Picture

    shown = ShownPictures()(View(Picture("main", Image(large(tmp_path / "x.jpg"))), 0, heading="state 0"))
    assert shown.startswith(b"\x89PNG")
