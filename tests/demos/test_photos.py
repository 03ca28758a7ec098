"""Photos: their order, and copies that tell nothing but what is seen."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from demos.photo_files import SECRET, photo
from pix2pred.demos import FolderError
from pix2pred.demos.authoring.photos import Order, find_photos, taken_at
from pix2pred.demos.photos.copies import clean_copy
from pix2pred.structs import Image


def names(folder: Path, order: Order = "auto") -> list[str]:
    (series,) = find_photos(folder, order)
    return [p.name for p in series.cameras["main"]]


def test_photos_are_in_the_order_of_their_times(tmp_path: Path) -> None:
    for name, minute in (("a.jpg", 3), ("b.jpg", 1), ("c.jpg", 2)):
        photo(tmp_path / name, time=f"2026:05:01 10:{minute:02}:00")
    assert names(tmp_path) == names(tmp_path, "time") == ["b.jpg", "c.jpg", "a.jpg"]
    assert names(tmp_path, "name") == ["a.jpg", "b.jpg", "c.jpg"]


def test_without_a_time_in_each_the_names_count(tmp_path: Path) -> None:
    photo(tmp_path / "IMG_10.jpg", time="2026:05:01 10:00:00")
    photo(tmp_path / "IMG_9.jpg", time="2026:05:01 11:00:00")
    photo(tmp_path / "IMG_2.jpg", time="0000:00:00 00:00:00")
    (series,) = find_photos(tmp_path)
    assert [p.name for p in series.cameras["main"]] == ["IMG_2.jpg", "IMG_9.jpg", "IMG_10.jpg"]
    assert "1 of 3 say no time" in series.note
    with pytest.raises(FolderError, match=r"IMG_2\.jpg: says no time"):
        find_photos(tmp_path, "time")


def test_photos_of_one_second_keep_the_order_of_their_names(tmp_path: Path) -> None:
    for i in (10, 9, 8):
        photo(tmp_path / f"burst{i}.jpg", time="2026:05:01 10:00:00")
    assert names(tmp_path) == ["burst8.jpg", "burst9.jpg", "burst10.jpg"]


@pytest.mark.parametrize(
    ("offsets", "order"),
    [
        (("+02:00", "+01:00", "+00:00"), "abc"),  # 8:00, 8:30 and 9:00 in UTC
        (("-05:00", "+01:00", "+09:30"), "cba"),
        (("+02:00", "+01:00", None), "cba"),  # one does not say: the cameras' clocks count
        ((None, None, None), "cba"),
        (("+02:00", "nonsense", "+00:00"), "cba"),
    ],
)
def test_photos_of_two_time_zones_are_ordered_by_the_moment(
    tmp_path: Path, offsets: tuple[str | None, ...], order: str
) -> None:
    for name, minute, offset in zip("abc", (60, 30, 0), offsets, strict=True):
        photo(tmp_path / f"{name}.jpg", time=f"2026:05:01 {9 + minute // 60:02}:{minute % 60:02}:00", offset=offset)
    assert names(tmp_path) == [f"{name}.jpg" for name in order]


@pytest.mark.parametrize("ending", ["jpg", "png"])
def test_a_copy_shows_the_same_and_tells_nothing(tmp_path: Path, ending: str) -> None:
    path = photo(tmp_path / f"x.{ending}", time="2026:05:01 10:00:00", orientation=6)
    assert SECRET.encode() in path.read_bytes()
    copy = clean_copy(path)
    assert SECRET.encode() not in copy.encoded and b"Exif" not in copy.encoded and b"2026" not in copy.encoded
    assert copy.size == (120, 160), "turned upright"
    off = np.abs(copy.pixels().astype(int) - Image(path).pixels()).mean()
    assert off < 3
    (tmp_path / "copy").write_bytes(copy.encoded)
    with PIL.Image.open(tmp_path / "copy") as opened:
        assert not opened.getexif()
    assert clean_copy(path).encoded == copy.encoded


def test_large_photos_shrink(tmp_path: Path) -> None:
    assert clean_copy(photo(tmp_path / "x.jpg", size=(640, 480)), 320).size == (320, 240)
    assert clean_copy(photo(tmp_path / "x.jpg", size=(640, 480)), 640).size == (640, 480)


def test_each_sub_folder_is_a_demonstration_with_a_plain_name(tmp_path: Path) -> None:
    for folder in ("Küche 1", "Kuche-1", "台所", ".hidden"):
        for i in range(2):
            photo(tmp_path / folder / f"{i}.JPG")
    assert [s.name for s in find_photos(tmp_path)] == ["Kuche-1", "Kuche-1-2", "demo"]


def test_a_folder_for_each_camera(tmp_path: Path) -> None:
    for camera in ("top", "left side"):
        for i in range(3):
            photo(tmp_path / "one" / camera / f"{i}.png", seed=i)
    (series,) = find_photos(tmp_path)
    assert list(series.cameras) == ["left-side", "top"] and len(series) == 3
    (tmp_path / "one/top/0.png").unlink()
    with pytest.raises(FolderError, match="different numbers of photos"):
        find_photos(tmp_path)


def test_everything_that_is_wrong_is_said_at_once(tmp_path: Path) -> None:
    photo(tmp_path / "a" / "1.jpg")
    (tmp_path / "empty").mkdir()
    photo(tmp_path / "b" / "1.jpg")
    (tmp_path / "b" / "2.HEIC").write_bytes(b"x")
    (tmp_path / "b" / "3.jpg").symlink_to("/etc/hostname")
    with pytest.raises(FolderError) as caught:
        find_photos(tmp_path)
    text = str(caught.value)
    for expected in ("a: holds one photo", "empty: holds no photo", "3.jpg: leads outside"):
        assert expected in text, text


@pytest.mark.parametrize(
    ("make", "message"), [("nothing", "does not exist"), ("x.zip", "unpack it"), ("dir", "no photo")]
)
def test_places_without_photos(tmp_path: Path, make: str, message: str) -> None:
    if make == "dir":
        (tmp_path / make).mkdir()
    elif make == "x.zip":
        (tmp_path / make).write_bytes(b"PK\3\4")
    with pytest.raises(FolderError, match=message):
        find_photos(tmp_path / make)


def test_photos_beside_folders_of_photos_are_refused(tmp_path: Path) -> None:
    photo(tmp_path / "1.jpg")
    photo(tmp_path / "a" / "1.jpg")
    with pytest.raises(FolderError, match="move the photos"):
        find_photos(tmp_path)


def test_a_damaged_photo_has_no_time(tmp_path: Path) -> None:
    path = photo(tmp_path / "x.jpg", time="2026:05:01 10:00:00")
    path.write_bytes(path.read_bytes()[:20])
    assert taken_at(path) is None
