"""How far a job is: one protocol for everything that reports and everything that shows it."""

from __future__ import annotations

from enum import StrEnum
from typing import Protocol


class Stage(StrEnum):
    """What a job is at. A job goes through some of them, in this order."""

    GENERATE = "generate"
    PHOTOS = "photos"
    IMPORT = "import"
    PROPOSE = "propose"
    LABEL = "label"
    SELECT = "select"
    DOUBT = "doubt"
    SOLVE = "solve"
    BENCH = "bench"
    DISTIL = "distil"


class Progress(Protocol):
    """Told how far a stage is. May be called from any thread."""

    def __call__(self, stage: Stage, done: int, total: int, text: str) -> None:
        """``done`` of ``total`` pieces of ``stage`` are done; ``text`` says what is going on, or is empty."""
        ...


def silent(stage: Stage, done: int, total: int, text: str) -> None:
    """Implements ``Progress``: shows nothing."""
