"""Single frames of a video file, by time (extra ``video``).

Only the file itself is opened: playlists, which name other files and addresses, are refused like every format that is
not a container of video.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from pix2pred.demos.files.folders import refusal
from pix2pred.structs import Pixels
from pix2pred.structs.states import MAX_PIXELS
from pix2pred.system.errors import Pix2predError
from pix2pred.system.extras import optional

VIDEO_ENDINGS = (".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi")
MAX_DECODED = 20_000
"""Frames decoded to reach one: more lie between two key frames in no video of a camera."""

_OPTIONS = {
    "format_whitelist": "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi",
    "protocol_whitelist": "file",
    "enable_drefs": "0",
    "use_absolute_path": "0",
}
_SLACK = 1.0
"""Seconds that a video may end before the moment asked for, whose last frame is then taken."""


class VideoError(Pix2predError, ValueError):
    """A video cannot be read, or has no frame at the time asked for; the message says why."""


def frames_at(path: Path, seconds: Sequence[float], root: Path) -> Iterator[Pixels]:
    """The frame shown closest to each of ``seconds``, upright. Raises ``VideoError`` or ``MissingExtraError``.

    ``path`` must not lead out of ``root``.
    """
    if message := refusal(path, root, "source"):
        raise VideoError(message)
    with _opened(path) as (container, stream):
        for moment in seconds:
            yield _frame_at(container, stream, moment)


@contextmanager
def _opened(path: Path) -> Iterator[tuple[Any, Any]]:
    av = optional("av", "video")
    try:
        with av.open(str(path), options=_OPTIONS) as container:
            if not container.streams.video:
                raise VideoError("holds no video")
            stream = container.streams.video[0]
            _refuse_size(stream.codec_context.width, stream.codec_context.height)
            stream.thread_type = "AUTO"
            yield container, stream
    except (av.FFmpegError, av.error.InvalidDataError) as error:
        raise VideoError(f"cannot be read as a video ({error.strerror or error}); it may be cut off") from error


def _frame_at(container: Any, stream: Any, moment: float) -> Pixels:
    """The frame nearest to ``moment``: from the key frame before it, decode until it has passed."""
    begin = float((stream.start_time or 0) * stream.time_base)
    container.seek(max(0, round((begin + moment) / stream.time_base)), stream=stream, backward=True)
    before: Any = None
    for decoded, frame in enumerate(container.decode(stream)):
        if decoded > MAX_DECODED:
            raise VideoError(f"has more than {MAX_DECODED} frames between key frames; encode it again")
        if frame.time is None:
            raise VideoError("has frames without a time; encode it again as MP4")
        passed = frame.time - begin - moment
        if passed >= 0:
            return _upright(before if before is not None and moment - (before.time - begin) <= passed else frame)
        before = frame
    last = None if before is None else before.time - begin
    if last is None or moment - last > _SLACK:
        end = "has no frame there" if last is None else f"ends at {last:.2f} s"
        raise VideoError(f"{end}: nothing shows {moment:g} s; it may be cut off")
    return _upright(before)


def _upright(frame: Any) -> Pixels:
    """RGB pixels, turned as the camera was held."""
    _refuse_size(frame.width, frame.height)
    pixels = frame.to_ndarray(format="rgb24")
    turns = round(frame.rotation / 90) % 4  # counter-clockwise
    return np.ascontiguousarray(np.rot90(pixels, turns), dtype=np.uint8)


def _refuse_size(width: int, height: int) -> None:
    if width * height > MAX_PIXELS:
        raise VideoError(f"has frames of {width}x{height} pixels; more than {MAX_PIXELS} are not read")
