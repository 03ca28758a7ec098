"""Folders of frames with lists of actions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from demos.importers.made_data import sidecar
from demos.photo_files import photo
from pix2pred.demos import FolderError
from pix2pred.demos.files.sidecar import read_sidecar
from pix2pred.demos.importers import drafts_of_frames


def frames(folder: Path, count: int) -> Path:
    for i in range(count):
        photo(folder / f"{i}.png", seed=i)
    return folder


def test_a_list_of_actions_names_the_steps(tmp_path: Path) -> None:
    source = frames(tmp_path / "tea", 3)
    (tmp_path / "tea.txt").write_text("Pick(robot, cup)\nPour(cup)\n")
    (draft,) = drafts_of_frames(source, read_sidecar(tmp_path / "tea.txt"))
    assert draft.actions == ("Pick(robot, cup)", "Pour(cup)")
    assert len(list(draft.states)) == 3
    (tmp_path / "tea.txt").write_text("Pick(robot, cup)\n")
    with pytest.raises(FolderError, match=r"tea.txt:1: 1 actions need 2 pictures, .* has 3"):
        drafts_of_frames(source, read_sidecar(tmp_path / "tea.txt"))


def test_positions_pick_frames(tmp_path: Path) -> None:
    source = frames(tmp_path / "tea", 8)
    file = sidecar(tmp_path / "s.yaml", {"name": "x", "start": 1, "steps": [{"do": "Pick(a)", "until": 6}]})
    (draft,) = drafts_of_frames(source, read_sidecar(file))
    digests = [state["main"].digest for state in draft.states]
    (whole,) = drafts_of_frames(source)
    every = [state["main"].digest for state in whole.states]
    assert digests == [every[1], every[6]] and whole.actions == (None,) * 7


@pytest.mark.parametrize(
    ("demos", "message"),
    [
        ([{"name": "c", "steps": [{"do": "P(a)"}]}], "no folder 'c'; there are a, b"),
        ([{"name": "x", "from": "../a", "steps": [{"do": "P(a)"}]}], "no folder '../a'"),
        ([{"name": "a", "steps": [{"do": "P(a)", "until": 3}]}], "no frame 3; .* has 3, counted from 0"),
    ],
)
def test_what_does_not_fit_is_said(tmp_path: Path, demos: list[dict[str, Any]], message: str) -> None:
    for name in ("a", "b"):
        frames(tmp_path / "all" / name, 3)
    with pytest.raises(FolderError, match=message):
        drafts_of_frames(tmp_path / "all", read_sidecar(sidecar(tmp_path / "s.yaml", *demos)))


def test_every_unreadable_photo_is_named(tmp_path: Path) -> None:
    source = frames(tmp_path / "tea", 5)
    for i in (1, 3):
        (source / f"{i}.png").write_bytes(b"junk")
    (draft,) = drafts_of_frames(source)
    with pytest.raises(FolderError) as caught:
        list(draft.states)
    assert [p.file.name for p in caught.value.problems] == ["1.png", "3.png"]
