"""Folders that appear at once or not at all: written near their place, then moved in.

What a killed process had begun is removed by the next one that writes to the same place: a folder in the making is
locked, and the lock ends with its process.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from pix2pred.demos.files.problems import FolderError
from pix2pred.system.locks import LockedError, held

_PREFIX, _LOCK = ".pix2pred-", "lock"


@contextmanager
def staged(directory: Path) -> Iterator[Path]:
    """A new hidden folder on the file system of ``directory``, removed in the end."""
    near = directory if directory.is_dir() else directory.parent
    near.mkdir(parents=True, exist_ok=True)
    _remove_abandoned(near)
    with tempfile.TemporaryDirectory(prefix=_PREFIX, dir=near) as made, held(Path(made) / _LOCK, wait=True):
        stage = Path(made) / "new"
        stage.mkdir()
        yield stage


def _remove_abandoned(near: Path) -> None:
    """Remove what processes that have ended had begun in ``near``."""
    for lock in near.glob(f"{_PREFIX}*/{_LOCK}"):
        try:
            with held(lock, wait=False):
                shutil.rmtree(lock.parent, ignore_errors=True)
        except (LockedError, OSError):  # somebody is writing there, or it is not ours
            continue


@contextmanager
def blamed(stage: Path, directory: Path) -> Iterator[None]:
    """Problems of staged files, told as problems of the files they would have become."""
    try:
        yield
    except FolderError as error:
        moved = [replace(p, file=directory / p.file.relative_to(stage)) for p in error.problems]
        raise FolderError(moved) from None


def move_in(stage: Path, directory: Path, names: Sequence[str]) -> None:
    """Replace the entries ``names`` of ``directory`` by those in ``stage``; on failure everything is put back."""
    if not directory.exists():
        stage.rename(directory)
        return
    old = stage.parent / "old"
    old.mkdir()
    moves: list[tuple[Path, Path]] = []

    def move(source: Path, target: Path) -> None:
        if source.exists() or source.is_symlink():
            source.rename(target)
            moves.append((source, target))

    try:
        for name in names:
            move(directory / name, old / name)
            move(stage / name, directory / name)
    except BaseException:
        for source, target in reversed(moves):
            target.rename(source)
        raise
