"""What a LeRobot dataset says about itself: its cameras, and where the frames of each episode are."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, Field, ValidationError

from pix2pred.demos.files.folders import MISSING, entries, is_folder, refusal
from pix2pred.demos.files.problems import Problem
from pix2pred.demos.files.sidecar import demo_name
from pix2pred.demos.files.yaml_lines import MAX_BYTES
from pix2pred.demos.importers.parquet import rows
from pix2pred.system.errors import Pix2predError, first_fault

MAX_EPISODES = 1_000_000
_PREFIX = "observation.images."
_FIELD = re.compile(r"\{(video_key|chunk_index|file_index|episode_chunk|episode_index)(?::0?(\d{1,2})d)?\}")
_PATHS = {
    2: (
        "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4",
    ),
    3: (
        "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
    ),
}
"""Where tables and videos lie by version, when the dataset does not say."""
_LONGEST_LINE = 1_000_000


class DatasetError(Pix2predError, ValueError):
    """A dataset cannot be read: what is wrong with which ``file``."""

    def __init__(self, file: Path, message: str) -> None:
        self.file = file
        super().__init__(message)


class FeatureDoc(BaseModel):
    """A column: what it holds and of what shape."""

    dtype: str
    shape: tuple[int, ...] = ()


class InfoDoc(BaseModel):
    """The part of ``meta/info.json`` that is used here."""

    codebase_version: str
    fps: Annotated[float, Field(gt=0, le=10_000, allow_inf_nan=False)]
    features: dict[str, FeatureDoc]
    chunks_size: int = Field(1000, ge=1)
    data_path: str | None = None
    video_path: str | None = None


@dataclass(frozen=True, slots=True)
class CameraColumn:
    """A column of pictures.

    ``key`` is its name in the data set, ``name`` that of the camera here; where ``is_video``, films hold it.
    """

    key: str
    name: str
    is_video: bool


@dataclass(frozen=True, slots=True)
class Dataset:
    """The folder ``source``, the version (2 or 3), frames per second, cameras, other columns, and how paths are made.

    Version 2 keeps a table and videos for each episode, ``chunks_size`` episodes to a folder.
    """

    source: Path
    version: int
    chunks_size: int
    fps: float
    cameras: tuple[CameraColumn, ...]
    numbers: tuple[str, ...]
    data_path: str
    video_path: str


@dataclass(frozen=True, slots=True)
class RecordedEpisode:
    """An episode of the data set.

    ``length`` counts its frames, ``tasks`` are in words, and ``row`` is the table row that says where its files lie.
    """

    dataset: Dataset
    number: int
    length: int
    tasks: tuple[str, ...]
    row: Mapping[str, Any]

    def video(self, key: str) -> tuple[Path, float]:
        """The file that shows it from the camera ``key``, and the second at which it begins there."""
        names: dict[str, str | int] = {"video_key": key, **self._place(f"videos/{key}/")}
        path = self.dataset.source / filled(self.dataset.video_path, names)
        if self.dataset.version == 2:
            return path, 0.0
        begin = self.row[f"videos/{key}/from_timestamp"]
        if not isinstance(begin, int | float) or not math.isfinite(begin) or begin < 0:
            raise DatasetError(self.dataset.source, f"episode {self.number} begins at {begin!r} s")
        return path, float(begin)

    def data(self) -> Path:
        """The table that holds its frames."""
        return self.dataset.source / filled(self.dataset.data_path, self._place("data/"))

    def cameras(self) -> tuple[CameraColumn, ...]:
        """Those of the dataset's cameras that have footage of this episode."""
        return tuple(c for c in self.dataset.cameras if not c.is_video or self._has_footage(c.key))

    def _has_footage(self, key: str) -> bool:
        if self.dataset.version == 2:
            return refusal(self.video(key)[0], self.dataset.source) != MISSING
        return self.row[f"videos/{key}/chunk_index"] is not None or self.row[f"videos/{key}/file_index"] is not None

    def _place(self, prefix: str) -> dict[str, int]:
        if self.dataset.version == 2:
            return {"episode_index": self.number, "episode_chunk": self.number // self.dataset.chunks_size}
        return {name: _whole(self.row[f"{prefix}{name}"], self.number) for name in ("chunk_index", "file_index")}


def read_info(source: Path) -> Dataset:
    """Read ``meta/info.json``. Raises ``DatasetError``."""
    file = source / "meta" / "info.json"
    if not is_folder(source):
        raise DatasetError(source, "is not a folder; give the folder of the dataset, which holds meta/info.json")
    if message := refusal(file, source):
        raise DatasetError(file, f"{message}; is this a LeRobot dataset?")
    try:
        if file.stat().st_size > MAX_BYTES:
            raise DatasetError(file, f"has more than {MAX_BYTES} bytes")
        data = json.loads(file.read_bytes())
        version = data.get("codebase_version") if isinstance(data, dict) else None
        known = re.match(r"v?([23])(\.|$)", str(version))
        if not known:
            message = f"the dataset's version is {str(version)[:20]!r}, this program reads v2 and v3"
            raise DatasetError(file, f"{message}; LeRobot converts from version to version")
        doc = InfoDoc.model_validate(data)
    except ValidationError as error:
        where, first = first_fault(error)
        raise DatasetError(file, f"{where}: {first['msg']}") from error
    except (OSError, RecursionError, json.JSONDecodeError, UnicodeDecodeError) as error:
        raise DatasetError(file, f"cannot be read as JSON ({error})") from error
    cameras: dict[str, CameraColumn] = {}
    for key, feature in doc.features.items():
        if feature.dtype in ("video", "image"):
            name = demo_name(key.removeprefix(_PREFIX).replace(".", "_"), list(cameras))
            cameras[name] = CameraColumn(key, name, feature.dtype == "video")
    if not cameras:
        raise DatasetError(file, "the dataset has no camera; nothing can be learned from it")
    numbers = tuple(key for key, feature in doc.features.items() if feature.dtype not in ("video", "image"))
    number = int(known[1])
    data_path, video_path = doc.data_path or _PATHS[number][0], doc.video_path or _PATHS[number][1]
    return Dataset(source, number, doc.chunks_size, doc.fps, tuple(cameras.values()), numbers, data_path, video_path)


def read_episodes(dataset: Dataset) -> dict[int, RecordedEpisode]:
    """The episodes of all tables below ``meta/episodes``, by number. Raises ``DatasetError``.

    Version 2 has a line for each in ``meta/episodes.jsonl``.
    """
    meta = dataset.source / "meta"
    if dataset.version == 2:
        place = meta / "episodes.jsonl"
        found = _episodes_of_lines(place, dataset)
    else:
        place = meta / "episodes"
        found = _episodes_of_tables(place, dataset)
    episodes: dict[int, RecordedEpisode] = {}
    for file, episode in found:
        episodes[episode.number] = episode
        if len(episodes) > MAX_EPISODES:
            raise DatasetError(file, f"more than {MAX_EPISODES} episodes are not read")
    if not episodes:
        raise DatasetError(place, "names no episode")
    return dict(sorted(episodes.items()))


def _episodes_of_tables(folder: Path, dataset: Dataset) -> Iterator[tuple[Path, RecordedEpisode]]:
    found: list[Problem] = []
    files = [f for chunk in entries(folder, found) for f in (entries(chunk, found) if is_folder(chunk) else [])]
    files = [f for f in files if f.suffix == ".parquet"]
    if not files:
        raise DatasetError(folder, "holds no table of episodes (chunk-000/file-000.parquet)")
    columns = ["episode_index", "length", "tasks"]
    if dataset.numbers or any(not camera.is_video for camera in dataset.cameras):
        columns += ["data/chunk_index", "data/file_index"]
    for camera in dataset.cameras:
        if camera.is_video:
            columns += [f"videos/{camera.key}/{c}" for c in ("chunk_index", "file_index", "from_timestamp")]
    for file in files:
        try:
            for row in rows(file, columns, dataset.source):
                yield file, _episode(row, dataset)
        except (TypeError, ValueError) as error:
            raise DatasetError(file, str(error)) from error


def _episodes_of_lines(file: Path, dataset: Dataset) -> Iterator[tuple[Path, RecordedEpisode]]:
    if message := refusal(file, dataset.source):
        raise DatasetError(file, message)
    try:
        with file.open(encoding="utf-8-sig") as lines:
            while line := lines.readline(_LONGEST_LINE):
                if line.strip():
                    yield file, _episode(json.loads(line), dataset)
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise DatasetError(file, f"cannot be read as a list of episodes ({error})") from error


def _episode(row: Mapping[str, Any], dataset: Dataset) -> RecordedEpisode:
    number = _whole(row["episode_index"], row["episode_index"])
    tasks = row["tasks"] if isinstance(row["tasks"], list) else [row["tasks"]]
    words = tuple(str(t) for t in tasks if t is not None)
    return RecordedEpisode(dataset, number, _whole(row["length"], number), words, row)


def _whole(value: object, episode: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 10**9:
        raise ValueError(f"episode {episode!r}: {value!r} is no count")
    return value


def filled(template: str, names: Mapping[str, str | int]) -> str:
    """A path made of ``template``, whose fields may be those of LeRobot and nothing else Python would format.

    Raises ``ValueError`` for an unknown field; where the path leads is for the reader to refuse.
    """

    def value(match: re.Match[str]) -> str:
        name, width = match[1], match[2]
        if name not in names:
            raise ValueError(f"the path {template[:100]!r} needs {name}")
        return str(names[name]).zfill(int(width or 0))

    path = _FIELD.sub(value, template)
    if set(_FIELD.sub("", template)) & {"{", "}"}:
        raise ValueError(f"the path {template[:100]!r} has fields that are not known here")
    return path
