"""LeRobot datasets in their formats v3 and v2 (extra ``lerobot``): episodes of robot data.

Version 3 packs many episodes into few files; version 2 has a table and videos for each.

::

    meta/info.json                                  frames per second, cameras, where files lie
    meta/episodes/chunk-000/file-000.parquet        for each episode: length, tasks, where its frames are
    data/chunk-000/file-000.parquet                 a row for each frame; holds the pictures of cameras without video
    videos/<camera>/chunk-000/file-000.mp4          the frames of many episodes, one after the other

Read with pyarrow and PyAV: the library that writes these files brings torch, which nothing here needs.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

from pix2pred.demos.authoring.drafts import Draft
from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.sidecar import Segment
from pix2pred.demos.files.unfilled import UNFILLED
from pix2pred.demos.importers.frames_of_video import frames_at
from pix2pred.demos.importers.lerobot_meta import CameraColumn, DatasetError, RecordedEpisode, read_episodes, read_info
from pix2pred.demos.importers.lerobot_rows import frame_times, subtasks
from pix2pred.demos.importers.parquet import picture_rows
from pix2pred.demos.photos.copies import MAX_SIDE, scaled
from pix2pred.structs import Image
from pix2pred.system.extras import optional


def drafts_of_lerobot(source: Path, segments: Sequence[Segment] = (), *, max_side: int = MAX_SIDE) -> tuple[Draft, ...]:
    """One draft for each segment, whose pictures are taken while it is written. Raises ``FolderError``.

    Without segments every episode is one, with the subtasks that the dataset names as steps to be filled in.
    """
    optional("pyarrow", "lerobot")
    found: list[Problem] = []
    try:
        dataset = read_info(source)
        if any(camera.is_video for camera in dataset.cameras):
            optional("av", "lerobot")
        episodes = read_episodes(dataset)
        if not segments:
            return tuple(_of_subtasks(episode, max_side) for episode in episodes.values())
        drafts = [_draft(segment, episodes, max_side, found) for segment in segments]
    except DatasetError as error:
        raise FolderError.about(error.file, str(error)) from error
    except FolderError:
        raise
    except ValueError as error:  # a place that is no number, or a path that cannot be
        raise FolderError.about(source, str(error)) from error
    if found:
        raise FolderError(found)
    return tuple(draft for draft in drafts if draft)


def _of_subtasks(episode: RecordedEpisode, max_side: int) -> Draft:
    """The draft of a whole episode: a state before its first subtask, and one after each."""
    parts = subtasks(episode)
    frames = (parts[0].first, *(min(part.end, episode.length - 1) for part in parts))
    name = f"episode-{episode.number}"
    pictures = _pictures(episode, frames, name, max_side)
    actions = tuple(f"{UNFILLED}: {part.words}" for part in parts)
    return Draft(name, actions, pictures, notes=_notes(episode))


def _draft(
    segment: Segment, episodes: Mapping[int, RecordedEpisode], max_side: int, found: list[Problem]
) -> Draft | None:
    doc = segment.doc
    number = doc.source
    if number is None and len(episodes) == 1:
        number = next(iter(episodes))
    if not isinstance(number, int) or number not in episodes:
        known = f"0 to {max(episodes)}" if len(episodes) == max(episodes) + 1 else ", ".join(map(str, [*episodes][:20]))
        message = f"'from' says which episode of the dataset it is: a number, {known}; found {number!r}"
        found.append(segment.problem(("from",) if number is not None else ("name",), message))
        return None
    episode = episodes[number]
    try:
        moments = segment.moments()
    except FolderError as error:
        found += error.problems
        return None
    times = frame_times(episode)
    late = next((i for i, moment in enumerate(moments) if moment >= times[-1] + 0.5 / episode.dataset.fps), None)
    if late is not None:
        message = f"episode {number} ends at {times[-1]:.2f} s; nothing shows {moments[-1]:g} s"
        found.append(segment.problem(("steps", late - 1) if late else ("start",), message))
        return None
    frames = [_nearest(times, moment) for moment in moments]
    for i, (frame, following) in enumerate(pairwise(frames)):
        if frame == following:
            found.append(segment.problem(("steps", i), f"begins and ends in one frame, {frame}"))
            return None
    where = f"{segment.sheet.file.name}: {doc.name}"
    pictures = _pictures(episode, frames, where, max_side)
    actions = tuple(s.do for s in doc.steps)
    return Draft(doc.name, actions, pictures, doc.objects, doc.goal, _notes(episode))


def _nearest(times: Sequence[float], moment: float) -> int:
    """The frame taken closest to ``moment``; of two equally close ones the later."""
    after = bisect_left(times, moment)
    if after == len(times):
        return after - 1
    return after - 1 if after and moment - times[after - 1] < times[after] - moment - 1e-9 else after


def _notes(episode: RecordedEpisode) -> tuple[str, ...]:
    """Where the demonstration comes from, and what is not brought over."""
    tasks = "; ".join(task.rstrip(".") for task in episode.tasks)[:300]
    left = ", ".join(episode.dataset.numbers) or "none"
    missing = [c.name for c in episode.dataset.cameras if c not in episode.cameras()]
    absent = (f"No footage of this episode from the camera {', '.join(missing)}.",) if missing else ()
    return (
        f"Episode {episode.number} of a LeRobot dataset{f', whose task is: {tasks}' if tasks else ''}.",
        f"Not brought over: per-frame numbers that belong to no object ({left[:300]}).",
        "Not known from the dataset: where the objects are (boxes), their features, given atoms of the source human.",
        *absent,
    )


def _pictures(
    episode: RecordedEpisode, frames: Sequence[int], where: str, max_side: int
) -> Iterator[Mapping[str, Image]]:
    """The pictures of the states of a segment, camera after camera, given state by state."""
    cameras = episode.cameras()
    if not cameras:
        message = f"no camera has footage of episode {episode.number} (for {where})"
        raise FolderError.about(episode.dataset.source, message)
    streams = {camera.name: _stream(episode, camera, frames, where, max_side) for camera in cameras}
    for _ in frames:
        yield {name: next(stream) for name, stream in streams.items()}


def _stream(
    episode: RecordedEpisode, camera: CameraColumn, frames: Sequence[int], where: str, max_side: int
) -> Iterator[Image]:
    """The pictures of one camera."""
    dataset = episode.dataset
    path = dataset.source
    try:
        if camera.is_video:
            path, begin = episode.video(camera.key)
            seconds = [begin + frame / dataset.fps for frame in frames]  # videos are evenly spaced
            for pixels in frames_at(path, seconds, dataset.source):
                yield Image.from_pixels(scaled(pixels, max_side))
        else:
            path = episode.data()
            wanted = [(episode.number, frame) for frame in frames]
            for encoded in picture_rows(path, camera.key, wanted, dataset.source):
                yield Image.from_pixels(scaled(Image(encoded).pixels(), max_side))
    except FolderError:
        raise
    except ValueError as error:  # of the video, the table, the picture, or a path that cannot be
        raise FolderError.about(path, f"{camera.key}: {error} (for {where})") from error
