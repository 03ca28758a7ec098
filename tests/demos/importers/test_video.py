"""Videos (extra ``video``): the frame of every moment, and files that are not what they claim."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from demos.importers.made_data import shown_frame, sidecar, write_video
from extras import need
from pix2pred.demos import FolderError
from pix2pred.demos.authoring.drafts import Draft
from pix2pred.demos.files.sidecar import read_sidecar
from pix2pred.demos.importers import drafts_of_videos
from pix2pred.demos.importers import frames_of_video as reader
from pix2pred.demos.importers.frames_of_video import VideoError, frames_at

pytestmark = need("av", extra="video")

STEPS = [{"do": "Pick(robot, cup)", "until": 1.3}, {"do": "TODO", "until": 3.0}]


def shown(path: Path, *seconds: float) -> list[int]:
    return [shown_frame(pixels) for pixels in frames_at(path, seconds, path.parent)]


def frames_of(draft: Draft) -> list[int]:
    return [shown_frame(state["main"].pixels()) for state in draft.states]


@pytest.mark.parametrize("ending", ["mp4", "mkv", "mov"])
def test_the_nearest_frame_is_taken(tmp_path: Path, ending: str) -> None:
    path = write_video(tmp_path / f"x.{ending}", 40)
    assert shown(path, 0, 0.04, 0.06, 1.1, 1.2, 2.34, 3.9, 4.5) == [0, 0, 1, 11, 12, 23, 39, 39]


def test_a_video_becomes_a_demonstration(tmp_path: Path) -> None:
    path = write_video(tmp_path / "tea.mp4", 40)
    file = sidecar(tmp_path / "tea.yaml", {"name": "tea-1", "start": 0.2, "steps": STEPS, "goal": ["Full(cup)"]})
    for source in (path, tmp_path):
        (draft,) = drafts_of_videos(source, read_sidecar(file))
        assert (draft.name, draft.actions, draft.goal) == ("tea-1", ("Pick(robot, cup)", "TODO"), ("Full(cup)",))
        assert frames_of(draft) == [2, 13, 30]
        assert any("Not known from a video" in note for note in draft.notes)


def test_a_video_held_sideways_is_turned_upright(tmp_path: Path) -> None:
    path = write_video(tmp_path / "x.mp4", 5)
    content = bytearray(path.read_bytes())
    at = content.index(b"tkhd") + 4 + 4 + 20 + 16  # version and flags; times, number, duration; layer and volume
    quarter = [0, 65536, 0, -65536, 0, 0, 0, 0, 1 << 30]
    content[at : at + 36] = b"".join(v.to_bytes(4, "big", signed=True) for v in quarter)
    path.write_bytes(content)
    (pixels,) = frames_at(path, [0.0], tmp_path)
    assert pixels.shape == (64, 48, 3)
    assert pixels[:8, -8:].mean() > 240, "the bright corner is at the upper right now"
    assert np.mean(pixels[:8, :8]) < 100


def test_which_video_is_said_by_from_or_name(tmp_path: Path) -> None:
    write_video(tmp_path / "a.mp4", 40)
    write_video(tmp_path / "b b.mp4", 40)
    named = [{"name": "a", "steps": STEPS}, {"name": "two", "from": "b b.mp4", "steps": STEPS}]
    assert len(drafts_of_videos(tmp_path, read_sidecar(sidecar(tmp_path / "s.yaml", *named)))) == 2
    wrong = [{"name": "c", "steps": STEPS}, {"name": "d", "from": "../a.mp4", "steps": STEPS}]
    with pytest.raises(FolderError) as caught:
        drafts_of_videos(tmp_path, read_sidecar(sidecar(tmp_path / "s.yaml", *wrong)))
    assert len(caught.value.problems) == 2 and "a.mp4, b b.mp4" in str(caught.value)


def test_a_time_after_the_end_is_named(tmp_path: Path) -> None:
    path = write_video(tmp_path / "x.mp4", 15)
    with pytest.raises(VideoError, match=r"ends at 1.40 s: nothing shows 30 s"):
        shown(path, 0.5, 30)
    (draft,) = drafts_of_videos(path, read_sidecar(sidecar(tmp_path / "s.yaml", {"name": "x", "steps": STEPS})))
    with pytest.raises(FolderError, match=r"x.mp4: ends at 1.40 s.*\(for s.yaml, line"):
        frames_of(draft)


@pytest.mark.parametrize("faststart", [False, True])
def test_a_truncated_video_is_one_error(tmp_path: Path, faststart: bool) -> None:
    path = write_video(tmp_path / "x.mp4", 40, size=(320, 240), faststart=faststart)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(VideoError, match="cut off"):
        shown(path, 0.0, 3.9)


@pytest.mark.parametrize(
    "content",
    [
        b"", b"\x00" * 1000, b"GIF89a", b"PK\x03\x04" * 50,
        b"#EXTM3U\n#EXT-X-VERSION:3\n#EXTINF:1,\nreal.mp4\n#EXT-X-ENDLIST\n",
        b"ffconcat version 1.0\nfile real.mp4\n",
    ],
)  # fmt: skip
@pytest.mark.parametrize("ending", ["mp4", "m3u8"])
def test_what_is_no_video_is_refused(tmp_path: Path, content: bytes, ending: str) -> None:
    write_video(tmp_path / "real.mp4", 10)
    (tmp_path / f"x.{ending}").write_bytes(content)
    with pytest.raises(VideoError, match="cannot be read as a video"):
        shown(tmp_path / f"x.{ending}", 0.1)


def test_links_and_folders_are_not_opened(tmp_path: Path) -> None:
    write_video(tmp_path / "real.mp4", 10)
    (tmp_path / "in").mkdir()
    (tmp_path / "in/x.mp4").symlink_to(tmp_path / "real.mp4")
    with pytest.raises(VideoError, match="outside"):
        shown(tmp_path / "in/x.mp4", 0.1)
    with pytest.raises(VideoError, match="not a regular file"):
        list(frames_at(tmp_path / "in", [0.1], tmp_path))


def test_absurd_sizes_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_video(tmp_path / "x.mp4", 5)
    monkeypatch.setattr(reader, "MAX_PIXELS", 1000)
    with pytest.raises(VideoError, match="64x48 pixels; more than 1000"):
        shown(path, 0.1)


def test_key_frames_too_far_apart_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_video(tmp_path / "x.mp4", 12)
    monkeypatch.setattr(reader, "MAX_DECODED", 3)
    assert shown(path, 0.2) == [2]
    with pytest.raises(VideoError, match="between key frames"):
        shown(path, 0.9)
