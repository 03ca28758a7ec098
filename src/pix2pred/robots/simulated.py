"""A simulated episode as a robot: the same program text, with neither network nor walking."""

from __future__ import annotations

from collections.abc import Sequence
from types import TracebackType
from typing import Self

from pix2pred.robots.robot import CameraView
from pix2pred.structs import Action, State
from pix2pred.structs.environment import Environment, Step


class SimulatedRobot:
    """Runs the skills of ``environment``. Only pictures and given atoms leave it."""

    def __init__(self, environment: Environment, name: str = "simulation") -> None:
        self.name = name
        self._environment = environment
        self._fresh: State | None = None

    def __enter__(self) -> Self:
        self._environment.reset()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._fresh = None

    def start(self) -> None:
        """Nothing has to be switched on."""

    @property
    def holding(self) -> str | None:
        """What a given atom of a hand and a thing names; None when there is no such atom."""
        held = [a for a in self.observe().given if len(a.objects) == 2]
        return held[0].objects[1].name if held else None

    def views(self) -> Sequence[CameraView]:
        return [CameraView(picture, None) for picture in self.observe().pictures]

    def observe(self) -> State:
        if self._fresh is None:
            self._fresh = self._environment.observe()
        return self._fresh

    def execute(self, action: Action) -> Step:
        self._fresh = None
        return self._environment.execute(action)
