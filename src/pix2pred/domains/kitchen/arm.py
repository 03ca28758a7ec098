"""Moves the gripper along straight lines: damped least squares on a kinematic copy, tracked by the arm's servos."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pix2pred.domains.physics import mujoco_library

Vector = NDArray[np.float64]

JOINTS = 7
"""The arm's joints come first in the model."""

PHYSICS_STEPS = 10
"""Steps of 2 ms between two commands."""

STEP = 0.008
"""Metres the commanded position moves between two commands: 0.4 m/s."""

FASTEST = 200.0
"""A joint velocity above this (rad/s or m/s) belongs to a simulation that has come apart."""

REST = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 0.7, 0.785])
"""Joint angles the arm keeps near as far as its task leaves it free."""

HOME = (0.4, 0.2, 2.2)
"""Where the gripper starts, in metres: aside, so that pictures show the stove."""

REST_AT_HOME = (-0.371, -0.73, -0.851, -2.523, 0.235, 0.749, 0.785)
"""Joint angles with the gripper at ``HOME``."""

_DAMPING = 0.05
_TURN_WEIGHT = 0.3
_REST_WEIGHT = 0.05
_ITERATIONS = 4
_MARGIN = 0.02
_REACHED = 0.03
_CLOSE = 0.01
_PATIENCE = 75


class DivergedError(RuntimeError):
    """The simulation has numbers that cannot be right."""


class UnreachableError(RuntimeError):
    """The arm cannot bring the gripper where it is asked to."""


class Arm:
    """The robot arm of a simulation. ``tick`` is called after every command.

    The command is a joint vector found by inverse kinematics on a copy of the arm that touches nothing; the real arm
    follows with its servos and may be held back by what it touches. ``pitch`` is how far the fingers point down:
    0 is horizontally away from the robot, pi/2 straight down. How the hand is rolled is left free.
    """

    def __init__(self, model: Any, data: Any, tick: Callable[[], None] = lambda: None) -> None:
        self._mujoco = mujoco_library()
        self._model = model
        self._data = data
        self._tick = tick
        self.pitch = np.pi / 2
        self._copy = self._mujoco.MjData(model)
        self._site = model.site("end_effector").id
        self.restart()

    def restart(self) -> None:
        """Take the arm as it is now: command the present joint angles, with the fingers closed."""
        self._copy.qpos[:] = self._data.qpos
        self._mujoco.mj_kinematics(self._model, self._copy)
        self._data.ctrl[:JOINTS] = self._data.qpos[:JOINTS]
        self._data.ctrl[JOINTS:] = 0.0

    @property
    def tip(self) -> Vector:
        """Where the fingertips are, in metres."""
        return np.array(self._data.site_xpos[self._site])

    @property
    def commanded(self) -> Vector:
        """Where the fingertips are asked to be."""
        return np.array(self._copy.site_xpos[self._site])

    def move(self, goal: ArrayLike, *, nearly: bool = False) -> None:
        """Go to ``goal`` along a straight line, or ``nearly`` there.

        Raises ``UnreachableError`` when no joint angles bring the gripper there, ``DivergedError``.
        """
        end = np.asarray(goal, dtype=float)
        start = self.commanded
        count = max(1, int(np.ceil(np.linalg.norm(end - start) / STEP)))
        for i in range(1, count + 1):
            self.command(start + (end - start) * i / count)
        for _ in range(_PATIENCE):
            if float(np.linalg.norm(self.tip - self.commanded)) < _CLOSE:
                break
            self.wait()
        off = float(np.linalg.norm(self.commanded - end))
        if off > _REACHED and not nearly:
            raise UnreachableError(f"the gripper stays {100 * off:.0f} cm away from {_metres(end)}")

    def command(self, position: Vector) -> None:
        """Ask for the gripper at ``position``, pointing forward, and let one command's time pass."""
        for _ in range(_ITERATIONS):
            self._improve(position)
        self._data.ctrl[:JOINTS] = self._copy.qpos[:JOINTS]
        self.wait()

    def hold(self) -> None:
        """Stay where the gripper is now, however far behind the command it was."""
        self.restart()

    def wait(self) -> None:
        """Let the time of one command pass. Raises ``DivergedError``."""
        for _ in range(PHYSICS_STEPS):
            self._mujoco.mj_step(self._model, self._data)
        values = np.concatenate([self._data.qpos, self._data.qvel])
        if not np.isfinite(values).all() or np.abs(self._data.qvel).max() > FASTEST:
            raise DivergedError("the physics diverged")
        self._tick()

    def _improve(self, position: Vector) -> None:
        """One step of damped least squares; what it leaves free draws the joints towards ``REST``."""
        mujoco, model, copy = self._mujoco, self._model, self._copy
        mujoco.mj_comPos(model, copy)
        points = copy.site_xmat[self._site].reshape(3, 3)[:, 2]
        wanted = np.array([0.0, np.cos(self.pitch), -np.sin(self.pitch)])
        off = np.concatenate([position - copy.site_xpos[self._site], _TURN_WEIGHT * np.cross(points, wanted)])
        linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jacSite(model, copy, linear, angular, self._site)
        across = np.eye(3) - np.outer(points, points)
        jacobian = np.concatenate([linear[:, :JOINTS], _TURN_WEIGHT * across @ angular[:, :JOINTS]])
        inverse = jacobian.T @ np.linalg.inv(jacobian @ jacobian.T + _DAMPING**2 * np.eye(6))
        joints = copy.qpos[:JOINTS]
        rest = (np.eye(JOINTS) - inverse @ jacobian) @ (REST - joints)
        low, high = model.jnt_range[:JOINTS].T
        copy.qpos[:JOINTS] = np.clip(joints + inverse @ off + _REST_WEIGHT * rest, low + _MARGIN, high - _MARGIN)
        mujoco.mj_kinematics(model, copy)


def _metres(point: Vector) -> str:
    return "(" + ", ".join(f"{v:.2f}" for v in point) + ")"
