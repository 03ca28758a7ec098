"""Films of episodes: what the robot does, and under every frame which skill runs and what it is expected to change."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from PIL import Image as PILImage
from PIL import ImageDraw, ImageFont

from pix2pred.structs import Action, GroundOperator, Pixels, State
from pix2pred.structs.environment import Environment, Filmed, Step
from pix2pred.structs.samplers import Features
from pix2pred.system.errors import Pix2predError
from pix2pred.system.extras import optional

FRAMES_PER_SECOND = 10
"""Environments that film a skill give a frame about every tenth of a second."""

WIDTH = 480
"""Pixels; pictures are scaled to it."""

STRIP = 96
"""Height in pixels of the strip for the words."""

FONT_SIZE, LINE_HEIGHT = 14, 19
"""Pixels; five lines fit into the strip."""

MARGIN = 8
"""Pixels left and right of the words."""

STILL_FRAMES = 8
"""How long the picture after a skill stands: long enough to read the words under it."""

LAST_FRAMES = 15
"""How long the last picture of an episode stands."""

BACKGROUND, HEADLINE, TEXT = (24, 24, 28), (255, 236, 120), (235, 235, 235)
"""Colours of the strip, its first line and the others."""


class FilmError(Pix2predError, ValueError):
    """A film cannot be written; the message says why."""


class Film:
    """An MP4 file being written (H.264). Use it as a context manager; nothing is left behind when it has no frame."""

    def __init__(self, path: Path) -> None:
        if path.suffix.lower() != ".mp4":
            raise FilmError(f"{path}: a film is written as MP4; end its name with .mp4")
        self._av = optional("av", "video")
        self._path = path
        self._container: Any = None
        self._stream: Any = None
        self._words: tuple[str, ...] = ()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._container is not None:
            self._container.mux(self._stream.encode())
            self._container.close()
            self._container = None

    def say(self, *lines: str) -> None:
        """The words under the frames from now on."""
        self._words = lines

    def frame(self, pixels: Pixels) -> None:
        """Add one frame; all frames get the size of the first."""
        picture = PILImage.fromarray(pixels)
        height = round(picture.height * WIDTH / picture.width)
        page = PILImage.new("RGB", (WIDTH, (height + STRIP) // 2 * 2), BACKGROUND)
        page.paste(picture.resize((WIDTH, height), PILImage.Resampling.BILINEAR), (0, 0))
        self._write(page, height)
        if self._container is None:
            self._open(page.size)
        video_frame = self._av.VideoFrame.from_ndarray(np.asarray(page), format="rgb24")
        self._container.mux(self._stream.encode(video_frame))

    def hold(self, pixels: Pixels, frames: int) -> None:
        """The same picture for a while."""
        for _ in range(frames):
            self.frame(pixels)

    def _open(self, size: tuple[int, int]) -> None:
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._container = self._av.open(str(self._path), "w")
        except OSError as error:
            raise FilmError(f"{self._path}: cannot be written ({error.strerror or error})") from error
        self._stream = self._container.add_stream("libx264", rate=FRAMES_PER_SECOND)
        self._stream.width, self._stream.height = size
        self._stream.pix_fmt = "yuv420p"

    def _write(self, page: PILImage.Image, top: int) -> None:
        font = ImageFont.load_default(FONT_SIZE)
        draw = ImageDraw.Draw(page)
        for i, line in enumerate(self._words[: STRIP // LINE_HEIGHT]):
            shown = line
            while shown and draw.textlength(shown, font=font) > WIDTH - 2 * MARGIN:
                shown = shown.removesuffix("…")[:-1] + "…"
            color = HEADLINE if i == 0 else TEXT
            draw.text((MARGIN, top + 6 + i * LINE_HEIGHT), shown, font=font, fill=color)


class FilmedEpisode:
    """An environment whose first episode is filmed. It behaves as ``inner`` does; later resets are not filmed."""

    def __init__(self, inner: Environment, film: Film, title: str) -> None:
        self._inner = inner
        self._film = film
        self._title = title
        self._rolling: bool | None = None

    def announce(self, operator: GroundOperator, action: Action) -> None:
        """The step of a plan that comes next."""
        if self._rolling:
            effects = [f"+ {atom}" for atom in sorted(operator.add)] + [f"- {atom}" for atom in sorted(operator.delete)]
            params = "with " + ", ".join(f"{p:.3f}" for p in action.params) if action.params else ""
            self._film.say(str(operator.action), *([params] if params else []), *effects)

    def reset(self) -> None:
        """Start the episode over."""
        self._inner.reset()
        self._rolling = self._rolling is None
        if self._rolling:
            self._film.say(self._title)
            self._film.hold(_pixels(self._inner.observe()), STILL_FRAMES)
        elif isinstance(self._inner, Filmed):
            self._inner.film(None)

    def observe(self) -> State:
        """The state now."""
        return self._inner.observe()

    def features(self) -> Features:
        """The features now."""
        return self._inner.features()

    def goal_reached(self) -> bool:
        """Whether the goal holds."""
        return self._inner.goal_reached()

    def execute(self, action: Action) -> Step:
        """Run a skill before the camera."""
        if not self._rolling:
            return self._inner.execute(action)
        if isinstance(self._inner, Filmed):
            self._inner.film(self._film.frame)
        step = self._inner.execute(action)
        self._film.hold(_pixels(self._inner.observe()), STILL_FRAMES)
        return step

    def conclude(self, words: Sequence[str]) -> None:
        """The last words, under the last picture of the filmed episode."""
        self._film.say(self._title, *words)
        if self._rolling:
            self._film.hold(_pixels(self._inner.observe()), LAST_FRAMES)


def _pixels(state: State) -> Pixels:
    if not state.pictures:
        raise FilmError("this environment shows no pictures; there is nothing to film")
    return state.pictures[0].image.pixels()
