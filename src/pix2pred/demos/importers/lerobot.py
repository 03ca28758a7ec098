"""LeRobot datasets in their format v3 (extra ``lerobot``): episodes of robot data, packed into few files.

::

    meta/info.json                                  frames per second, cameras, where files lie
    meta/episodes/chunk-000/file-000.parquet        for each episode: length, tasks, where its frames are
    data/chunk-000/file-000.parquet                 a row for each frame; holds the pictures of cameras without video
    videos/<camera>/chunk-000/file-000.mp4          the frames of many episodes, one after the other

Read with pyarrow and PyAV: the library that writes these files brings torch, which nothing here needs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from pix2pred.demos.authoring.drafts import Draft
from pix2pred.demos.authoring.photos import MAX_SIDE, scaled
from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.sidecar import Segment
from pix2pred.demos.importers.frames_of_video import frames_at
from pix2pred.demos.importers.lerobot_meta import DatasetError, Info, RecordedEpisode, read_episodes, read_info
from pix2pred.demos.importers.parquet import picture_rows
from pix2pred.structs import Image
from pix2pred.system.extras import optional


def drafts_of_lerobot(source: Path, segments: Sequence[Segment], *, max_side: int = MAX_SIDE) -> tuple[Draft, ...]:
    """One draft for each segment, whose pictures are taken while it is written. Raises ``FolderError``."""
    optional("pyarrow", "lerobot")
    try:
        info = read_info(source)
        if any(camera.is_video for camera in info.cameras):
            optional("av", "lerobot")
        episodes = read_episodes(source, info)
    except DatasetError as error:
        raise FolderError([Problem(error.file, None, str(error))]) from error
    found: list[Problem] = []
    drafts = [_draft(segment, info, episodes, source, max_side, found) for segment in segments]
    if found:
        raise FolderError(found)
    return tuple(draft for draft in drafts if draft)


def _draft(
    segment: Segment,
    info: Info,
    episodes: Mapping[int, RecordedEpisode],
    source: Path,
    max_side: int,
    found: list[Problem],
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
    end = (episode.length - 1) / info.fps
    frames = [round(moment * info.fps) for moment in moments]
    if frames[-1] >= episode.length:
        message = f"episode {number} ends at {end:.2f} s; nothing shows {moments[-1]:g} s"
        late = next(i for i, frame in enumerate(frames) if frame >= episode.length)
        found.append(segment.problem(("steps", late - 1) if late else ("start",), message))
        return None
    for i, (frame, following) in enumerate(pairwise(frames)):
        if frame == following:
            found.append(segment.problem(("steps", i), f"begins and ends in one frame, {frame}"))
            return None
    pictures = _Pictures(source, info, episode, tuple(frames), segment, max_side)
    return Draft(doc.name, tuple(s.do for s in doc.steps), pictures, doc.objects, doc.goal, _notes(info, episode))


def _notes(info: Info, episode: RecordedEpisode) -> tuple[str, ...]:
    """Where the demonstration comes from, and what is not brought over."""
    tasks = "; ".join(episode.tasks)[:300]
    left = ", ".join(info.numbers) or "none"
    return (
        f"Episode {episode.number} of a LeRobot dataset{f', whose task is: {tasks}' if tasks else ''}.",
        f"Not brought over: per-frame numbers that belong to no object ({left[:300]}).",
        "Not known from the dataset: where the objects are (boxes), their features, given atoms of the source human.",
    )


@dataclass(frozen=True, slots=True)
class _Pictures:
    """The pictures of the states of a segment, camera after camera, given state by state."""

    source: Path
    info: Info
    episode: RecordedEpisode
    frames: tuple[int, ...]
    segment: Segment
    max_side: int

    def __iter__(self) -> Iterator[Mapping[str, Image]]:
        streams = {camera.name: self._of(camera.key, camera.is_video) for camera in self.info.cameras}
        for _ in self.frames:
            yield {name: next(stream) for name, stream in streams.items()}

    def _of(self, key: str, is_video: bool) -> Iterator[Image]:
        path = self.source
        try:
            if is_video:
                path, begin = self.episode.video(self.source, self.info, key)
                seconds = [begin + frame / self.info.fps for frame in self.frames]
                for pixels in frames_at(path, seconds, self.source):
                    yield Image.from_pixels(scaled(pixels, self.max_side))
            else:
                path = self.episode.data(self.source, self.info)
                wanted = [(self.episode.number, frame) for frame in self.frames]
                for encoded in picture_rows(path, key, wanted, self.source):
                    yield Image.from_pixels(scaled(Image(encoded).pixels(), self.max_side))
        except FolderError:
            raise
        except ValueError as error:  # of the video, the table, the picture, or a path that cannot be
            where = f"{self.segment.sheet.file.name}: {self.segment.doc.name}"
            raise FolderError([Problem(path, None, f"{key}: {error} (for {where})")]) from error
