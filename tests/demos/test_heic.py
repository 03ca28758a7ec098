"""HEIC photos become JPEG on import: with the extra, upright, ordered by time; without, one sentence."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from command_line import Cli
from demos.photo_files import photo
from extras import need
from pix2pred.demos.authoring import clean_copy
from pix2pred.demos.authoring.photos import find_photos, taken_at
from pix2pred.demos.photos import heic as heic_module
from pix2pred.structs import PictureError
from pix2pred.system.extras import MissingExtraError

SIDEWAYS = Path(__file__).parents[1] / "data" / "heic" / "sideways.heic"
"""160 x 120 with a white corner and a red and a blue half, to be shown turned by a quarter."""

with_extra = need("pi_heif", extra="heic")


@pytest.fixture
def cli(capfd: pytest.CaptureFixture[str]) -> Cli:
    return Cli(lambda: (read := capfd.readouterr()) and (read.out, read.err))


@with_extra
@pytest.mark.parametrize("name", ["a.heic", "a.HEIF", "a.jpg"])
def test_a_copy_is_a_jpeg_that_shows_the_same_upright(tmp_path: Path, name: str) -> None:
    path = Path(shutil.copy(SIDEWAYS, tmp_path / name))
    copy = clean_copy(path)
    assert copy.encoded.startswith(b"\xff\xd8\xff") and b"secret maker" not in copy.encoded
    pixels = copy.pixels().astype(int)
    assert copy.size == (120, 160)
    for (x, y), color in {(110, 10): (250, 250, 250), (10, 10): (200, 40, 40), (60, 150): (40, 60, 200)}.items():
        assert np.abs(pixels[y, x] - color).max() < 12
    assert max(clean_copy(path, 80).size) == 80


@with_extra
def test_they_are_ordered_by_time_among_others(tmp_path: Path) -> None:
    shutil.copy(SIDEWAYS, tmp_path / "b.heic")  # taken at ten
    photo(tmp_path / "a.jpg", time="2026:05:01 10:30:00")
    photo(tmp_path / "c.jpg", time="2026:05:01 09:30:00")
    assert taken_at(tmp_path / "b.heic") is not None
    (series,) = find_photos(tmp_path)
    assert [p.name for p in series.cameras["main"]] == ["c.jpg", "b.heic", "a.jpg"]


@with_extra
def test_a_project_begins_with_them(cli: Cli, tmp_path: Path) -> None:
    for n in range(2):
        (tmp_path / "photos").mkdir(exist_ok=True)
        shutil.copy(SIDEWAYS, tmp_path / "photos" / f"IMG_{n}.HEIC")
    assert cli("init", tmp_path / "p", "--from-photos", tmp_path / "photos").code == 0
    assert sorted(p.name for p in (tmp_path / "p/demos").rglob("*.jpg")) == ["main.jpg", "main.jpg"]


@with_extra
@pytest.mark.parametrize("keep", [12, 300, 800])
def test_a_damaged_one_is_one_sentence(tmp_path: Path, keep: int) -> None:
    (tmp_path / "a.heic").write_bytes(SIDEWAYS.read_bytes()[:keep])
    assert taken_at(tmp_path / "a.heic") is None or keep > 300
    with pytest.raises(PictureError, match=r"a\.heic: cannot be read as a picture"):
        clean_copy(tmp_path / "a.heic")


def test_without_the_extra_the_command_to_install_is_named(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def absent(module: str, extra: str) -> None:
        raise MissingExtraError(f"{module} is not installed; install it with: pip install 'pix2pred[{extra}]'")

    monkeypatch.setattr(heic_module, "optional", absent)
    (tmp_path / "photos").mkdir()
    for n in range(2):
        shutil.copy(SIDEWAYS, tmp_path / "photos" / f"{n}.heic")
    ran = cli("init", tmp_path / "p", "--from-photos", tmp_path / "photos")
    assert ran.code == 2 and not (tmp_path / "p").exists()
    for text in ("0.heic", "1.heic", "pip install 'pix2pred[heic]'", "export it as JPEG"):
        assert text in ran.err
