"""What a robot offers: pictures from named cameras, skills that it runs, what it holds, and an end that is safe."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from types import TracebackType
from typing import Protocol, Self

from pix2pred.structs import Action, Picture, State
from pix2pred.structs.environment import Step
from pix2pred.structs.space.poses import Pose
from pix2pred.system.errors import Pix2predError


class Outcome(StrEnum):
    """How the work on a task ended."""

    GOAL = "goal reached"
    NO_PLAN = "no plan"
    GAVE_UP = "gave up"
    DECLINED = "declined"
    STOPPED = "stopped by a person"
    NOT_READY = "not ready"
    LEASE_LOST = "lease lost"
    ESTOPPED = "emergency stop"
    FALLEN = "fallen"
    BATTERY_EMPTY = "battery empty"
    CAMERA_SILENT = "camera silent"
    LOST = "does not know where it is"
    BLOCKED = "does not get to where it looks from"
    CONNECTION_LOST = "connection lost"


class RobotError(Pix2predError):
    """The robot cannot go on; ``outcome`` says how for programs, the message for people, with what to do."""

    def __init__(self, outcome: Outcome, message: str) -> None:
        super().__init__(message)
        self.outcome = outcome


@dataclass(frozen=True, slots=True)
class RobotMemory:
    """What an earlier session with a robot left: where its map of tags is kept, and what its hand held.

    ``under_way`` is a skill that was begun and whose end nobody saw, because the session ended in it.
    """

    map_file: Path | None = None
    holding: str | None = None
    under_way: str = ""


@dataclass(frozen=True, slots=True)
class CameraView:
    """A picture, upright, and where its camera was (x right, y down, z forward) in the map; None when unknown."""

    picture: Picture
    pose: Pose | None


class Robot(Protocol):
    """A robot ready to work. It is a context manager; leaving it makes it safe, whatever happened within."""

    name: str

    def __enter__(self) -> Self:
        """Connect and get ready, moving nothing. Raises ``RobotError``."""
        ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop, put the arm away, give back what was taken. Raises nothing."""
        ...

    def start(self) -> None:
        """From now on it may move: power on and stand up. Raises ``RobotError``."""
        ...

    @property
    def holding(self) -> str | None:
        """The name of the object in the hand."""
        ...

    def views(self) -> Sequence[CameraView]:
        """A look around from where the scene is seen best; only after ``start``. Raises ``RobotError``."""
        ...

    def observe(self) -> State:
        """The state now: the pictures of ``views``, and the given atoms about the hand. Raises ``RobotError``."""
        ...

    def execute(self, action: Action) -> Step:
        """Run one skill until it ends or fails. Raises ``RobotError`` when nothing more can be run."""
        ...
