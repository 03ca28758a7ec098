"""The same bytes whatever the hash seed and whatever compressed the pictures.

The answer store keeps pictures as they came, named by their pixels: of these the pixels are compared.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import PIL.Image


def _pixels(path: Path) -> bytes:
    with PIL.Image.open(path) as picture:
        return picture.convert("RGB").tobytes()


def _results(folder: Path) -> dict[str, bytes]:
    return {
        str(p.relative_to(folder)): _pixels(p) if p.parent.name == "blobs" else p.read_bytes()
        for p in sorted(folder.rglob("*"))
        if p.is_file() and p.name not in ("timings.json", "report.html", ".lock")
    }


def test_hash_seed_and_compression_change_no_byte(project: Path, learned: Path, tmp_path: Path) -> None:
    data, run = tmp_path / "stacks", tmp_path / "run"
    shutil.copytree(project, data)
    pictures = list(data.rglob("*.png"))
    assert len(pictures) > 100
    for path in pictures:
        with PIL.Image.open(path) as picture:
            picture.load()
        before = path.read_bytes()
        picture.save(path, "PNG", compress_level=0 if len(before) % 2 else 3)
        assert path.read_bytes() != before
    program = [sys.executable, "-c", "from pix2pred.cli import main; main()", "learn", str(data), "--out", str(run)]
    subprocess.run(program, env={**os.environ, "PYTHONHASHSEED": "12345"}, check=True, capture_output=True)
    assert _results(run) == _results(learned)
