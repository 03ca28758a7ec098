"""What a LeRobot dataset says frame by frame: when each frame was taken, and which subtask it belongs to."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pix2pred.demos.files.folders import MISSING, refusal
from pix2pred.demos.importers.lerobot_meta import DatasetError, RecordedEpisode
from pix2pred.demos.importers.parquet import ParquetError, rows

_TIME, _SUBTASK, _FRAME, _EPISODE = "timestamp", "subtask_index", "frame_index", "episode_index"
_NAMES = ("subtask", "__index_level_0__")
"""Columns that may hold what a subtask is called: its own, or the index of the table that pandas wrote."""


@dataclass(frozen=True, slots=True)
class Subtask:
    """A stretch of frames, from ``first`` to before ``end``, and what is done in it."""

    words: str
    first: int
    end: int


def frame_times(episode: RecordedEpisode) -> tuple[float, ...]:
    """The second of the episode at which each of its frames was taken; evenly spaced where no table says it.

    Raises ``DatasetError``.
    """
    dataset = episode.dataset
    even = tuple(i / dataset.fps for i in range(episode.length))
    if not {_TIME, _FRAME, _EPISODE} <= {*dataset.numbers} or refusal(episode.data(), dataset.source) == MISSING:
        return even
    times = [row[_TIME] for row in _rows_of(episode, _TIME)]
    known = [float(t) for t in times if isinstance(t, int | float) and t == t]
    if len(known) != episode.length or sorted(known) != known:
        return even
    return tuple(t - known[0] for t in known)


def subtasks(episode: RecordedEpisode) -> tuple[Subtask, ...]:
    """The subtasks of an episode in order; frames without one belong to the one before. Raises ``DatasetError``."""
    if _SUBTASK not in episode.dataset.numbers:
        message = "says of no frame which subtask it belongs to; write the steps down and name them with --sidecar"
        raise DatasetError(episode.dataset.source, message)
    words = _words(episode.dataset.source)
    found: list[Subtask] = []
    for frame, row in enumerate(_rows_of(episode, _SUBTASK)):
        number = row[_SUBTASK]
        known = isinstance(number, int) and number >= 0
        text = words.get(number, f"subtask {number}") if known else ""
        if found and (not known or text == found[-1].words):
            found[-1] = Subtask(found[-1].words, found[-1].first, frame + 1)
        elif known:
            found.append(Subtask(text, frame, frame + 1))
    if not found:
        raise DatasetError(episode.data(), f"names no subtask of episode {episode.number}")
    return tuple(found)


def _rows_of(episode: RecordedEpisode, column: str) -> list[dict[str, Any]]:
    """The rows of an episode with a ``column``; they follow one another in a table of one or many."""
    path = episode.data()
    found: list[dict[str, Any]] = []
    try:
        for row in rows(path, [_EPISODE, column], episode.dataset.source):
            if row[_EPISODE] == episode.number:
                found.append(row)
            elif found:
                break
    except ParquetError as error:
        raise DatasetError(path, str(error)) from error
    return found


def _words(source: Path) -> dict[int, str]:
    """What the subtasks are called, by number; nothing when the dataset does not say it."""
    path = source / "meta" / "subtasks.parquet"
    if refusal(path, source) == MISSING:
        return {}
    for column in _NAMES:
        try:
            return {row[_SUBTASK]: str(row[column])[:200] for row in rows(path, [_SUBTASK, column], source)}
        except ParquetError as error:
            problem = error
    raise DatasetError(path, str(problem)) from problem
