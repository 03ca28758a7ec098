"""Progress of learning, passed on with what was asked meanwhile, and the seconds that each stage took."""

from __future__ import annotations

import time
from typing import Any

from pix2pred.system.progress import Progress, Stage
from pix2pred.vlm import CountingVLM


class StageClock:
    """Implements ``Progress``: passes everything on to ``progress`` and measures how long each stage takes.

    While ``vlm`` is asked, the text is what was asked of it so far, brought up to date with every answer.
    """

    def __init__(self, progress: Progress, vlm: CountingVLM | None = None) -> None:
        self._progress = progress
        self._vlm = vlm
        self._start = time.perf_counter()
        self._begun: dict[Stage, float] = {}
        self._latest = (Stage.PROPOSE, 0, 1)
        if vlm is not None:
            vlm.on_answer = lambda: progress(*self._latest, vlm.usage.line())

    def __call__(self, stage: Stage, done: int, total: int, text: str) -> None:
        self._begun.setdefault(stage, time.perf_counter())
        self._latest = (stage, done, total)
        asks = stage in (Stage.PROPOSE, Stage.LABEL)
        self._progress(stage, done, total, self._vlm.usage.line() if self._vlm and asks else text)

    def seconds(self) -> float:
        """Seconds since the start."""
        return round(time.perf_counter() - self._start, 3)

    def timings(self) -> dict[str, Any]:
        """Seconds in total and by stage; the last stage ends now."""
        seconds = self.seconds()
        stages = sorted(self._begun.items(), key=lambda item: item[1])
        ends = [*(t for _, t in stages[1:]), self._start + seconds]
        return {
            "seconds": seconds,
            "stages": {name.value: round(end - begin, 3) for (name, begin), end in zip(stages, ends, strict=True)},
        }
