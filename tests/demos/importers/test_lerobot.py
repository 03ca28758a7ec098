"""LeRobot datasets of format v3 (extra ``lerobot``), made with pyarrow and PyAV; and hostile ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from demos.importers import made_data
from demos.importers.made_data import shown_frame, sidecar, write_dataset
from extras import need
from pix2pred.demos import FolderError
from pix2pred.demos.files.sidecar import Segment, read_sidecar
from pix2pred.demos.importers import drafts_of_lerobot, lerobot_meta, parquet
from pix2pred.demos.importers.lerobot_meta import filled

pytestmark = need("pyarrow", "av", extra="lerobot")

STEPS = [{"do": "Pick(robot, cube)", "until": 0.6}, {"do": "Put(robot, cube)", "until": 1.2}]


def segments(folder: Path, episode: Any = 1, **more: Any) -> tuple[Segment, ...]:
    return read_sidecar(sidecar(folder / "s.yaml", {"name": "one", "from": episode, "steps": STEPS, **more}))


def brought(source: Path, folder: Path, **more: Any) -> list[dict[str, int]]:
    (draft,) = drafts_of_lerobot(source, segments(folder, **more))
    return [{camera: shown_frame(image.pixels()) for camera, image in state.items()} for state in draft.states]


def test_frames_of_both_kinds_of_camera(tmp_path: Path) -> None:
    source = write_dataset(tmp_path / "data")
    assert brought(source, tmp_path, episode=0) == [{"front": i, "wrist_cam": i} for i in (0, 6, 12)]
    assert brought(source, tmp_path, episode=1, start=0.1) == [{"front": i, "wrist_cam": i} for i in (16, 21, 27)]
    (draft,) = drafts_of_lerobot(source, segments(tmp_path))
    assert "put cube 1 away" in draft.notes[0] and "observation.state" in draft.notes[1]


def test_a_dataset_written_by_lerobot_itself(tmp_path: Path) -> None:
    source = Path(__file__).parents[2] / "data/lerobot"
    assert brought(source, tmp_path, episode=0) == [{"front": i, "wrist": i} for i in (0, 6, 12)]
    assert brought(source, tmp_path, episode=1, start=0.1) == [{"front": i, "wrist": i} for i in (16, 21, 27)]
    (draft,) = drafts_of_lerobot(source, segments(tmp_path))
    assert "put cube 1 away" in draft.notes[0] and "(observation.state, action, " in draft.notes[1]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"episode": 2}, "a number, 0 to 1; found 2"),
        ({"episode": "one"}, "found 'one'"),
        ({"steps": [{"do": "A(b)", "until": 9}]}, "episode 1 ends at 1.90 s; nothing shows 9 s"),
        ({"steps": [{"do": "A(b)", "until": 0.04}]}, "in one frame, 0"),
        ({"steps": [{"do": "A(b)"}]}, "'until' is missing"),
    ],
)
def test_what_the_side_car_gets_wrong(tmp_path: Path, more: dict[str, Any], message: str) -> None:
    source = write_dataset(tmp_path / "data")
    with pytest.raises(FolderError, match=message) as caught:
        brought(source, tmp_path, **more)
    assert caught.value.problems[0].line


@pytest.mark.parametrize(
    ("info", "message"),
    [
        ({"codebase_version": "v1.6"}, "version is 'v1.6', this program reads v2 and v3"),
        ({"codebase_version": None}, "reads v2 and v3"),
        ({"fps": 0}, "fps"),
        ({"fps": float("nan")}, "fps"),
        ({"features": {}}, "no camera"),
        ({"features": []}, "features"),
        ({"video_path": "../../../etc/{video_key}"}, "does not exist|leads outside"),
        ({"video_path": "/etc/passwd"}, "leads outside"),
        ({"video_path": "{video_key:99999999999d}"}, "not known here"),
        ({"video_path": "{video_key.__class__}"}, "not known here"),
        ({"video_path": "x\x00{video_key}"}, "null"),
        ({"data_path": "../{chunk_index}"}, "does not exist|leads outside"),
        ({"data_path": "{video_key}"}, "needs video_key"),
    ],
)
def test_hostile_descriptions(tmp_path: Path, info: dict[str, Any], message: str) -> None:
    source = write_dataset(tmp_path / "data", info=info)
    with pytest.raises(FolderError, match=message):
        brought(source, tmp_path)


@pytest.mark.parametrize("content", [b"", b"[]", b"{", b"[" * 100_000, b"\xff\xfe", b'{"codebase_version": "v3.0"}'])
def test_junk_in_the_description(tmp_path: Path, content: bytes) -> None:
    source = write_dataset(tmp_path / "data")
    (source / "meta/info.json").write_bytes(content)
    with pytest.raises(FolderError, match=r"info\.json"):
        brought(source, tmp_path)


@pytest.mark.parametrize("victim", ["meta/episodes/chunk-000/file-000.parquet", "data/chunk-000/file-000.parquet"])
@pytest.mark.parametrize(
    "content", [b"", b"PAR1", b"x" * 2000, b"PAR1" + b"\x00" * 100 + b"\xff\xff\xff\x7fPAR1", None]
)
def test_damaged_tables(tmp_path: Path, victim: str, content: bytes | None) -> None:
    source = write_dataset(tmp_path / "data")
    whole = (source / victim).read_bytes()
    (source / victim).write_bytes(whole[: len(whole) // 2] if content is None else content)
    with pytest.raises(FolderError, match=r"file-000\.parquet: .*cannot be read as a Parquet table"):
        brought(source, tmp_path)


def test_tables_of_something_else(tmp_path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    source = write_dataset(tmp_path / "data")
    pq.write_table(pa.table({"episode_index": [0]}), source / "meta/episodes/chunk-000/file-000.parquet")
    with pytest.raises(FolderError, match="has no column 'length'"):
        brought(source, tmp_path)


@pytest.mark.parametrize("value", [-1, 2**40, None, "many", 1.5, True])
def test_counts_that_are_none(tmp_path: Path, value: Any) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    source = write_dataset(tmp_path / "data")
    file = source / "meta/episodes/chunk-000/file-000.parquet"
    rows = pq.read_table(file).to_pylist()
    pq.write_table(pa.Table.from_pylist([row | {"length": value} for row in rows]), file)
    with pytest.raises(FolderError, match="is no count"):
        brought(source, tmp_path)


def test_a_table_that_unpacks_to_too_much(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    source = write_dataset(tmp_path / "data")
    file = source / "data/chunk-000/file-000.parquet"
    bomb = {"bytes": b"\x00" * 5_000_000, "path": ""}
    rows = [row | {"observation.images.wrist.cam": bomb} for row in pq.read_table(file).to_pylist()]
    pq.write_table(pa.Table.from_pylist(rows), file, compression="zstd", use_dictionary=False)
    assert file.stat().st_size < 1_000_000
    monkeypatch.setattr(parquet, "MAX_UNPACKED", 100_000_000)
    with pytest.raises(FolderError, match="unpacks to 17"):
        brought(source, tmp_path)
    monkeypatch.setattr(parquet, "MAX_ROWS", 10)
    with pytest.raises(FolderError, match="claims 35 rows"):
        brought(source, tmp_path)


def test_pictures_that_are_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(made_data, "_png", lambda frame: b"no picture")
    source = write_dataset(tmp_path / "data")
    with pytest.raises(FolderError, match="neither PNG nor JPEG"):
        brought(source, tmp_path)


def test_links_out_of_the_dataset_are_not_followed(tmp_path: Path) -> None:
    source = write_dataset(tmp_path / "data")
    video = source / "videos/observation.images.front/chunk-000/file-000.mp4"
    video.rename(tmp_path / "elsewhere.mp4")
    video.symlink_to(tmp_path / "elsewhere.mp4")
    with pytest.raises(FolderError, match="leads outside"):
        brought(source, tmp_path)


def test_a_folder_that_is_no_dataset(tmp_path: Path) -> None:
    for source in (tmp_path / "nothing", tmp_path):
        with pytest.raises(FolderError, match=r"info\.json"):
            brought(source, tmp_path)


def test_paths_are_filled_in() -> None:
    names: dict[str, str | int] = {"video_key": "a.b", "chunk_index": 7, "file_index": 12}
    assert filled(lerobot_meta._PATHS[3][0], names) == "data/chunk-007/file-012.parquet"
    assert filled("{video_key}/{chunk_index}", {**names, "video_key": "{file_index}"}) == "{file_index}/7"
