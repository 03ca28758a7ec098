"""Progress of learning, passed on with what was asked meanwhile, and the seconds that each stage took."""

from __future__ import annotations

import time
from typing import Any

from pix2pred.system.progress import Progress, Stage
from pix2pred.vlm import CountingVLM


class StageClock:
    """Implements ``Progress``: passes everything on to ``progress`` and measures how long each stage takes.

    While ``vlm`` is asked, progress is counted in answers, of which labelling takes at least ``questions``; the text is
    what was asked so far.
    """

    def __init__(self, progress: Progress, vlm: CountingVLM | None = None, questions: int = 0) -> None:
        self._progress = progress
        self._vlm = vlm
        self._questions = questions
        self._answered_before = 0
        self._start = time.perf_counter()
        self._begun: dict[Stage, float] = {}
        self._latest = (Stage.PROPOSE, 0, 1)
        if vlm is not None:
            vlm.on_answer = self._answered

    def __call__(self, stage: Stage, done: int, total: int, text: str) -> None:
        if stage not in self._begun:
            self._begun[stage] = time.perf_counter()
            self._answered_before = self._vlm.usage.queries if self._vlm else 0
        if self._vlm is not None and stage == Stage.LABEL:
            done, total = self._in_answers(self._vlm, ended=done == total)
        self._latest = (stage, done, total)
        asks = stage in (Stage.PROPOSE, Stage.LABEL)
        self._progress(stage, done, total, self._vlm.usage.line() if self._vlm and asks else text)

    def _answered(self) -> None:
        assert self._vlm is not None, "something was asked"
        stage, done, total = self._latest
        if stage == Stage.LABEL:
            done, total = self._in_answers(self._vlm, ended=False)
        self._progress(stage, done, total, self._vlm.usage.line())

    def _in_answers(self, vlm: CountingVLM, *, ended: bool) -> tuple[int, int]:
        """Answers about labels so far, and how many there will be at least; more follow where answers are unusable."""
        done = vlm.usage.queries - self._answered_before
        return done, done if ended else max(self._questions, done + 1)

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
