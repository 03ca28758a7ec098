"""A video, or a folder of videos, with a table of the times at which actions are done (extra ``video``)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from pix2pred.demos.authoring.drafts import Draft
from pix2pred.demos.authoring.photos import MAIN
from pix2pred.demos.files.folders import entries, is_folder
from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.sidecar import Segment
from pix2pred.demos.importers.frames_of_video import VIDEO_ENDINGS, VideoError, frames_at
from pix2pred.demos.photos.copies import MAX_SIDE, scaled
from pix2pred.structs import Image
from pix2pred.system.extras import optional

UNKNOWN = "Not known from a video: where the objects are (boxes), their features, given atoms of the source human."


def drafts_of_videos(source: Path, segments: Sequence[Segment], *, max_side: int = MAX_SIDE) -> tuple[Draft, ...]:
    """One draft for each segment, whose frames are taken while it is written. Raises ``FolderError``."""
    optional("av", "video")
    if not source.exists():
        raise FolderError.about(source, "does not exist")
    found: list[Problem] = []
    videos = _videos(source, found)
    drafts = []
    for segment in segments:
        path = _video_of(segment, source, videos, found)
        try:
            moments = segment.moments()
        except FolderError as error:
            found += error.problems
            continue
        if path is not None:
            doc = segment.doc
            shown = ", ".join(f"{moment:g}" for moment in moments[:100])
            notes = (f"Frames of a video at {shown} seconds.", UNKNOWN)
            frames = _frames(path, source if is_folder(source) else source.resolve().parent, moments, segment, max_side)
            drafts.append(Draft(doc.name, tuple(s.do for s in doc.steps), frames, doc.objects, doc.goal, notes))
    if found:
        raise FolderError(found)
    return tuple(drafts)


def _videos(source: Path, found: list[Problem]) -> list[Path]:
    if not is_folder(source):
        return [source]
    return [p for p in entries(source, found) if p.suffix.lower() in VIDEO_ENDINGS]


def _video_of(segment: Segment, source: Path, videos: Sequence[Path], found: list[Problem]) -> Path | None:
    wanted = segment.doc.source
    if wanted is None and len(videos) == 1:
        return videos[0]
    name = str(wanted) if wanted is not None else segment.doc.name
    for path in videos:
        if name in (path.name, path.stem):
            return path
    known = ", ".join(p.name for p in videos[:20]) or f"none ({', '.join(VIDEO_ENDINGS)})"
    loc = ("from",) if wanted is not None else ("name",)
    message = f"{source} has no video {name!r}; there are: {known}; say which with 'from'"
    found.append(segment.problem(loc, message))
    return None


def _frames(
    path: Path, root: Path, moments: tuple[float, ...], segment: Segment, max_side: int
) -> Iterator[Mapping[str, Image]]:
    """The frames of the film ``path`` that show the states of a segment, at ``moments`` in seconds.

    They are made smaller until the longer side has ``max_side`` pixels.
    """
    given = 0
    try:
        for pixels in frames_at(path, moments, root):
            given += 1
            yield {MAIN: Image.from_pixels(scaled(pixels, max_side))}
    except VideoError as error:
        file, line = segment.sheet.file, segment.problem(("steps", max(0, given - 1)), "").line
        raise FolderError.about(path, f"{error} (for {file.name}, line {line})") from error
