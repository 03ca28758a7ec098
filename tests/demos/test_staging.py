"""Writing happens whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from pix2pred.demos.files.staging import move_in, staged


def tree(directory: Path) -> dict[str, str]:
    return {p.name: p.read_text() for p in sorted(directory.iterdir())}


def test_entries_are_replaced_and_others_stay(tmp_path: Path) -> None:
    for name in ("a", "b", "other"):
        (tmp_path / name).write_text("old")
    with staged(tmp_path) as stage:
        (stage / "a").write_text("new")
        (stage / "c").write_text("new")
        move_in(stage, tmp_path, ["a", "b", "c"])
    assert tree(tmp_path) == {"a": "new", "c": "new", "other": "old"}


@pytest.mark.parametrize("calls", range(5))
def test_a_failure_half_way_puts_everything_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, calls: int) -> None:
    for name in ("a", "b"):
        (tmp_path / name).write_text("old")
    rename, left = Path.rename, calls

    def fail_once(self: Path, target: Path) -> Path:
        nonlocal left
        left -= 1
        if left == -1:
            raise OSError("disk full")
        return rename(self, target)

    with staged(tmp_path) as stage:
        for name in ("a", "b", "c"):
            (stage / name).write_text("new")
        monkeypatch.setattr(Path, "rename", fail_once)
        with pytest.raises(OSError, match="disk full"):
            move_in(stage, tmp_path, ["a", "b", "c"])
    assert tree(tmp_path) == {"a": "old", "b": "old"}


def test_a_failure_before_moving_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), staged(tmp_path / "new"):
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_process_left_is_removed_and_what_another_writes_is_not(tmp_path: Path) -> None:
    for name in ("killed", "foreign"):
        (tmp_path / f".pix2pred-{name}" / "new" / "demos").mkdir(parents=True)
    (tmp_path / ".pix2pred-killed" / "lock").touch()
    with staged(tmp_path) as first:
        assert [p.name for p in tmp_path.glob(".pix2pred-*") if p != first.parent] == [".pix2pred-foreign"]
        with staged(tmp_path):
            assert first.is_dir()
    assert [p.name for p in tmp_path.iterdir()] == [".pix2pred-foreign"]
