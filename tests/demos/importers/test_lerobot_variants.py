"""LeRobot datasets as people have them: of version 2, with cameras that are missing, subtasks, and their own clocks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from demos.importers.made_data import rewrite, shown_frame, sidecar, write_dataset, write_v2_dataset, write_video
from extras import need
from pix2pred.demos import FolderError
from pix2pred.demos.authoring import Draft
from pix2pred.demos.files.sidecar import Segment, read_sidecar
from pix2pred.demos.importers import drafts_of_lerobot

pytestmark = need("pyarrow", "av", extra="lerobot")

STEPS = [{"do": "Pick(robot, cube)", "until": 0.6}, {"do": "Put(robot, cube)", "until": 1.2}]
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
FRAMES = "data/chunk-000/file-000.parquet"


def segments(folder: Path, episode: int) -> tuple[Segment, ...]:
    return read_sidecar(sidecar(folder / "s.yaml", {"name": "one", "from": episode, "steps": STEPS}))


def shown(draft: Draft) -> list[dict[str, int]]:
    return [{camera: shown_frame(image.pixels()) for camera, image in state.items()} for state in draft.states]


@pytest.mark.parametrize(("episode", "chunks_size"), [(0, 1000), (1, 1000), (1, 1)])
def test_version_2_has_a_video_for_each_episode(tmp_path: Path, episode: int, chunks_size: int) -> None:
    source = write_v2_dataset(tmp_path / "data", chunks_size=chunks_size)
    (draft,) = drafts_of_lerobot(source, segments(tmp_path, episode))
    assert shown(draft) == [{"front": 0}, {"front": 6}, {"front": 12}]
    assert f"put cube {episode} away" in draft.notes[0]


@pytest.mark.parametrize("version", ["v2.0", "v2.1", "2.1", "v2"])
@pytest.mark.parametrize("begin", ["", "\ufeff"])
def test_version_2_is_read_however_it_is_written(tmp_path: Path, version: str, begin: str) -> None:
    source = write_v2_dataset(tmp_path / "data")
    for file, old in ((source / "meta/info.json", '"v2.1"'), (source / "meta/episodes.jsonl", "\n")):
        text = file.read_text().replace(old, f'"{version}"' if old != "\n" else "\r\n")
        file.write_bytes((begin + text).encode())
    (draft,) = drafts_of_lerobot(source, segments(tmp_path, 1))
    assert shown(draft) == [{"front": 0}, {"front": 6}, {"front": 12}]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda root: (root / "meta/episodes.jsonl").unlink(), "episodes.jsonl: does not exist"),
        (lambda root: (root / "meta/episodes.jsonl").write_text("{"), "cannot be read as a list of episodes"),
        (lambda root: (root / "meta/episodes.jsonl").write_text("\n"), "names no episode"),
        (lambda root: (root / "meta/episodes.jsonl").write_text('{"episode_index": 0}'), "'tasks'"),
    ],
)
def test_a_list_of_episodes_that_cannot_be_read(tmp_path: Path, change: Any, message: str) -> None:
    source = write_v2_dataset(tmp_path / "data", (5,))
    change(source)
    with pytest.raises(FolderError, match=message):
        drafts_of_lerobot(source, segments(tmp_path, 0))


def without(column: str, episode: int) -> Any:
    """A change of the table of episodes: no footage from a camera."""

    def change(row: dict[str, Any]) -> dict[str, Any]:
        missing = row["episode_index"] == episode
        return {k: None if missing and k.startswith(f"videos/{column}/") else v for k, v in row.items()}

    return change


def test_a_camera_that_an_episode_lacks_is_said_and_left_out(tmp_path: Path) -> None:
    source = write_dataset(tmp_path / "data")
    rewrite(source / EPISODES, without("observation.images.front", 0))
    (lacking,) = drafts_of_lerobot(source, segments(tmp_path, 0))
    assert [sorted(s) for s in shown(lacking)] == [["wrist_cam"]] * 3
    assert "No footage of this episode from the camera front." in lacking.notes
    (whole,) = drafts_of_lerobot(source, segments(tmp_path, 1))
    assert [sorted(s) for s in shown(whole)] == [["front", "wrist_cam"]] * 3
    assert not any("No footage" in note for note in whole.notes)


def test_a_video_that_is_not_there_in_version_2_is_a_missing_camera(tmp_path: Path) -> None:
    source = write_v2_dataset(tmp_path / "data")
    info = json.loads((source / "meta/info.json").read_text())
    info["features"]["observation.images.wrist"] = {"dtype": "video", "shape": [48, 64, 3]}
    (source / "meta/info.json").write_text(json.dumps(info))
    write_video(source / "videos/chunk-000/observation.images.wrist/episode_000001.mp4", 20)
    first, second = (drafts_of_lerobot(source, segments(tmp_path, e))[0] for e in (0, 1))
    assert "No footage of this episode from the camera wrist." in first.notes
    assert [sorted(s) for s in shown(second)] == [["front", "wrist"]] * 3


def test_an_episode_without_any_camera_is_refused_in_words(tmp_path: Path) -> None:
    source = write_v2_dataset(tmp_path / "data")
    (source / "videos/chunk-000/observation.images.front/episode_000000.mp4").unlink()
    (draft,) = drafts_of_lerobot(source, segments(tmp_path, 0))
    with pytest.raises(FolderError, match=r"no camera has footage of episode 0 \(for s.yaml: one\)"):
        shown(draft)


def with_subtasks(source: Path, numbers: list[int | None], *, words: str | None = "subtask") -> Path:
    """The first episode's frames belong to subtasks; ``words`` is the column with their names."""
    info = json.loads((source / "meta/info.json").read_text())
    info["features"] |= {name: {"dtype": "int64", "shape": [1]} for name in ("subtask_index", "frame_index")}
    (source / "meta/info.json").write_text(json.dumps(info))
    rewrite(source / FRAMES, lambda row: row | {"subtask_index": numbers[row["index"]]})
    if words:
        named = source / "meta/subtasks.parquet"
        named.write_bytes((source / EPISODES).read_bytes())
        called = ["pick up", "put away"]
        rewrite(named, lambda row: {"subtask_index": row["episode_index"], words: called[row["episode_index"]]})
    return source


@pytest.mark.parametrize("column", ["subtask", "__index_level_0__", None])
def test_subtasks_become_steps_to_fill_in(tmp_path: Path, column: str | None) -> None:
    numbers: list[int | None] = [None, 0, 0, 0, 0, None, 1, 1, 1, 1, -1, -1, -1, -1, -1, *[0] * 20]
    source = with_subtasks(write_dataset(tmp_path / "data"), numbers, words=column)
    first, second = drafts_of_lerobot(source)
    expected = ("TODO: pick up", "TODO: put away") if column else ("TODO: subtask 0", "TODO: subtask 1")
    assert (first.name, first.actions) == ("episode-0", expected)
    assert [state["front"] for state in shown(first)] == [1, 6, 14]
    assert second.actions == expected[:1]
    assert [state["front"] for state in shown(second)] == [15, 34]


def test_a_dataset_without_subtasks_asks_for_the_steps(tmp_path: Path) -> None:
    with pytest.raises(FolderError, match="name them with --sidecar"):
        drafts_of_lerobot(write_dataset(tmp_path / "data"))


def test_frames_are_found_by_the_times_they_were_taken_at(tmp_path: Path) -> None:
    source = write_dataset(tmp_path / "data")
    info = json.loads((source / "meta/info.json").read_text())
    info["features"] |= {n: {"dtype": "float32", "shape": [1]} for n in ("timestamp", "frame_index", "episode_index")}
    (source / "meta/info.json").write_text(json.dumps(info))
    late = 0.3  # the camera took nothing for a while after its fourth frame
    rewrite(source / FRAMES, lambda row: row | {"timestamp": row["timestamp"] + late * (row["frame_index"] > 3)})
    (draft,) = drafts_of_lerobot(source, segments(tmp_path, 0))
    assert shown(draft) == [{"front": i, "wrist_cam": i} for i in (0, 4, 9)]


@pytest.mark.parametrize(
    "name", ["meta/info.json", EPISODES, FRAMES, "videos/observation.images.front/chunk-000/file-000.mp4"]
)
def test_pointers_of_git_lfs_are_called_what_they_are(tmp_path: Path, name: str) -> None:
    source = write_dataset(tmp_path / "data")
    (source / name).write_text(f"version https://git-lfs.github.com/spec/v1\noid sha256:{'0' * 64}\nsize 12345\n")
    with pytest.raises(FolderError, match="is a pointer of Git LFS, not the file itself; fetch it with: git lfs pull"):
        shown(drafts_of_lerobot(source, segments(tmp_path, 0))[0])
