"""Where a body is: on the floor (place and direction) and in space (a rotation and a translation). Metres, radians."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def wrapped(angle: float) -> float:
    """The same direction between -pi and pi."""
    return math.atan2(math.sin(angle), math.cos(angle))


@dataclass(frozen=True, slots=True)
class FloorPose:
    """A place on the floor and the direction faced there, counter-clockwise from x."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def __mul__(self, other: FloorPose) -> FloorPose:
        """``other``, which is seen from here, as seen from where this pose is seen from."""
        x, y = self.point(other.x, other.y)
        return FloorPose(x, y, wrapped(self.yaw + other.yaw))

    @property
    def inverse(self) -> FloorPose:
        """The origin as seen from here."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return FloorPose(-c * self.x - s * self.y, s * self.x - c * self.y, -self.yaw)

    def point(self, x: float, y: float) -> tuple[float, float]:
        """A point seen from here as seen from where this pose is seen from."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return self.x + c * x - s * y, self.y + s * x + c * y

    def distance(self, other: FloorPose) -> float:
        """Metres between the places."""
        return math.hypot(self.x - other.x, self.y - other.y)

    def turn_to(self, other: FloorPose) -> float:
        """Radians to turn by, without a sign, from this direction to the other's."""
        return abs(wrapped(other.yaw - self.yaw))


def _identity() -> Array:
    return np.eye(3)


def _origin() -> Array:
    return np.zeros(3)


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """A frame seen from another one: its axes as the columns of ``axes`` (3 by 3), its origin ``at`` (3)."""

    at: Array = field(default_factory=_origin)
    axes: Array = field(default_factory=_identity)

    @classmethod
    def on_floor(cls, pose: FloorPose, height: float = 0.0) -> Pose:
        """An upright frame over a place on the floor."""
        return cls(np.array([pose.x, pose.y, height]), turned_about_z(pose.yaw))

    @classmethod
    def looking(cls, at: Sequence[float], yaw: float, pitch: float) -> Pose:
        """A frame whose x axis points to the direction ``yaw`` and down by ``pitch``, its y axis level."""
        return cls(np.array(at, dtype=float), turned_about_z(yaw) @ turned_about_y(pitch))

    def __mul__(self, other: Pose) -> Pose:
        """``other``, which is seen from here, as seen from where this pose is seen from."""
        return Pose(self.at + self.axes @ other.at, self.axes @ other.axes)

    @property
    def inverse(self) -> Pose:
        """The other frame as seen from here."""
        return Pose(-self.axes.T @ self.at, self.axes.T)

    def points(self, points: Array) -> Array:
        """Points seen from here, an array of shape (..., 3), as seen from where this pose is seen from."""
        return points @ self.axes.T + self.at

    @property
    def floor(self) -> FloorPose:
        """The place under it, and where its x axis points along the floor."""
        return FloorPose(float(self.at[0]), float(self.at[1]), math.atan2(self.axes[1, 0], self.axes[0, 0]))

    def angle_to(self, other: Pose) -> float:
        """Radians of the rotation between the two frames."""
        trace = float(np.trace(self.axes.T @ other.axes))
        return math.acos(min(1.0, max(-1.0, (trace - 1) / 2)))

    def towards(self, other: Pose, share: float) -> Pose:
        """The frame after ``share`` of the way to the other, turning about one axis."""
        relative = self.axes.T @ other.axes
        angle = self.angle_to(other)
        axis = _axis(relative, angle)
        return Pose(self.at + share * (other.at - self.at), self.axes @ turned_about(axis, share * angle))


def _axis(rotation: Array, angle: float) -> Array:
    """The axis of a rotation by ``angle``; for half a turn from the symmetric part."""
    skew = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    if math.pi - angle > 1e-4:
        return np.asarray(skew / max(float(np.linalg.norm(skew)), 1e-12), dtype=np.float64)
    square = (rotation + np.eye(3)) / 2
    column = square[:, int(np.argmax(np.diag(square)))]
    return np.asarray(column / float(np.linalg.norm(column)), dtype=np.float64)


def turned_about(axis: Array, angle: float) -> Array:
    """The rotation by ``angle`` about a unit vector (Rodrigues' formula)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return np.asarray(turn, dtype=np.float64)


def turned_about_x(angle: float) -> Array:
    """The rotation by ``angle`` about x."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def turned_about_y(angle: float) -> Array:
    """The rotation by ``angle`` about y: it brings x down."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def turned_about_z(angle: float) -> Array:
    """The rotation by ``angle`` about z, counter-clockwise."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def quaternion_of(axes: Array) -> tuple[float, float, float, float]:
    """The rotation as (w, x, y, z), w not negative."""
    m = axes
    candidates = np.array([np.trace(m), m[0, 0], m[1, 1], m[2, 2]])
    i = int(np.argmax(candidates))
    if i == 0:
        q = np.array([1 + m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    elif i == 1:
        q = np.array([m[2, 1] - m[1, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]])
    elif i == 2:
        q = np.array([m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], 1 - m[0, 0] + m[1, 1] - m[2, 2], m[1, 2] + m[2, 1]])
    else:
        q = np.array([m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], 1 - m[0, 0] - m[1, 1] + m[2, 2]])
    q = q / np.linalg.norm(q) * (1 if q[0] >= 0 else -1)
    w, x, y, z = (float(v) for v in q)
    return w, x, y, z


def axes_of(w: float, x: float, y: float, z: float) -> Array:
    """The rotation of a quaternion of any length but zero."""
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
