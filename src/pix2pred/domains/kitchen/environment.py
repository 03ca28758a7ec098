"""One episode of a kitchen task: the physics, the arm, and what a skill comes to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pix2pred.domains.kitchen.arm import Arm, DivergedError, UnreachableError
from pix2pred.domains.kitchen.classifiers import features_of, holds
from pix2pred.domains.kitchen.model import kitchen_camera, kitchen_model
from pix2pred.domains.kitchen.observe import observe
from pix2pred.domains.kitchen.skills import PushFailedError, run_skill
from pix2pred.domains.kitchen.world import KitchenWorld
from pix2pred.domains.physics import mujoco_library
from pix2pred.structs import Action, Atom, State
from pix2pred.structs.environment import FrameSink, Step, StepStatus
from pix2pred.structs.samplers import Features

HORIZON = 4000
"""Commands to the arm in one episode, 50 a second."""

_COMMANDS_PER_FRAME = 5


class _HorizonError(RuntimeError):
    """The episode's commands are used up."""


class KitchenEnvironment:
    """An episode that starts in ``initial``. ``data`` is the ground truth; only states are meant to leave."""

    def __init__(self, initial: KitchenWorld, goal: Sequence[Atom], horizon: int = HORIZON) -> None:
        self.steps = 0
        self._horizon = horizon
        self._initial = initial
        self._goal = tuple(goal)
        self._sink: FrameSink | None = None
        self._model = kitchen_model()
        self.data: Any = mujoco_library().MjData(self._model)
        self.reset()

    @property
    def world(self) -> KitchenWorld:
        """The joint positions now."""
        return KitchenWorld(tuple(float(v) for v in self.data.qpos))

    def reset(self) -> None:
        """Start the episode over."""
        self.steps = 0
        self._show(self._initial)

    def _show(self, world: KitchenWorld) -> None:
        mujoco = mujoco_library()
        mujoco.mj_resetData(self._model, self.data)
        self.data.qpos[:] = world.positions
        mujoco.mj_forward(self._model, self.data)
        self._arm = Arm(self._model, self.data, self._tick)

    def observe(self) -> State:
        """The state now."""
        return observe(self.data)

    def features(self) -> Features:
        """Positions and angles now, without drawing."""
        return features_of(self.data)

    def goal_reached(self) -> bool:
        """Whether every goal atom is true now."""
        return all(holds(self.data, atom) for atom in self._goal)

    def film(self, sink: FrameSink | None) -> None:
        """Hand ``sink`` a frame every tenth of a simulated second while skills run; ``None`` stops."""
        self._sink = sink

    def execute(self, action: Action) -> Step:
        """Run one skill. It never raises: what cannot work is ``STUCK`` with a sentence about the cause."""
        before = self.world
        try:
            run_skill(action, self._arm, self.data)
        except _HorizonError:
            return Step(
                StepStatus.HORIZON, f"{action} had not ended when the episode's {self._horizon} commands were used up"
            )
        except DivergedError as error:
            self._show(before)
            return Step(StepStatus.STUCK, f"{action}: {error}; the state from before is restored")
        except (PushFailedError, UnreachableError) as error:
            return Step(StepStatus.STUCK, f"{action}: {error}")
        return Step(StepStatus.DONE)

    def _tick(self) -> None:
        self.steps += 1
        if self._sink and self.steps % _COMMANDS_PER_FRAME == 0:
            self._sink(kitchen_camera().pixels(self.data))
        if self.steps >= self._horizon:
            raise _HorizonError
