"""What a simulated robot stands in: a world that shows what is seen from a place and yields to a hand.

The robot knows its own body and frames, its surroundings know everything else. Poses are in the room unless said
otherwise; the place of the robot is the point on the floor under its nose.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from pix2pred.structs.space.poses import Array, FloorPose, Pose
from pix2pred.structs.states import Pixels


@dataclass(frozen=True, slots=True)
class CameraMount:
    """A camera with square pixels and no distortion: its picture's size and focal length in pixels.

    ``pose`` (x right, y down, z forward) is seen from the place of the robot, or from its hand if it is ``in_hand``.
    """

    name: str
    width: int
    height: int
    focal: float
    pose: Pose
    in_hand: bool = False


@dataclass(frozen=True, slots=True)
class Seen:
    """What a ray meets first: the point, and the object it belongs to if it belongs to one."""

    at: Array
    name: str | None


class Grip(StrEnum):
    """What came of closing the hand around an object."""

    TAKEN = "taken"
    NOTHING = "nothing to take"
    STUCK = "cannot be taken from where it is"


class Surroundings(Protocol):
    """A world around a robot. Used from one thread only."""

    @property
    def cameras(self) -> Sequence[CameraMount]:
        """The robot's cameras."""
        ...

    @property
    def names(self) -> Sequence[str]:
        """The objects, in the order of the numbers that ``owners`` gives their pixels, from 1 on."""
        ...

    @property
    def start(self) -> FloorPose:
        """Where the robot stands first."""
        ...

    @property
    def holding(self) -> str | None:
        """What the hand holds."""
        ...

    def stands(self, place: FloorPose) -> bool:
        """Whether the robot can stand at ``place``: no furniture is in its way."""
        ...

    def put_robot(self, place: FloorPose, hand: Pose) -> None:
        """The robot stands at ``place`` and its hand is at ``hand`` in the room; pictures are taken from there."""
        ...

    def colour(self, camera: str) -> Pixels:
        """What a camera takes, as it is mounted."""
        ...

    def depth(self, camera: str) -> NDArray[np.float32]:
        """Metres along the camera's axis at every pixel."""
        ...

    def owners(self, camera: str) -> NDArray[np.int32]:
        """Which object every pixel shows: its number in ``names`` from 1 on, 0 for what is none."""
        ...

    def seen(self, origin: Array, direction: Array) -> Seen | None:
        """What a ray meets first; None when it meets nothing."""
        ...

    def grasp(self, name: str) -> Grip:
        """The hand, which is there and was empty, closes around an object."""
        ...

    def let_go(self) -> None:
        """The hand opens: what it held falls from where the hand is."""
        ...

    def move_hand(self, path: Sequence[Pose]) -> int:
        """The hand goes through ``path``, with effects on what it holds and meets; how many of its poses it reached."""
        ...

    def truth(self) -> dict[str, Any]:
        """The whole state, JSON-compatible, for tests and for judging how an episode ended; no robot is told."""
        ...

    def close(self) -> None:
        """Free what drawing needs."""
        ...


@runtime_checkable
class Roamable(Protocol):
    """A simulated domain in whose worlds a robot can walk."""

    def roaming(self, family: str, seed: int, index: int) -> Surroundings:
        """The start of the test task with the given number, to walk in."""
        ...
