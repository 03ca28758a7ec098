"""Where a body is: on the floor (place and direction) and in space (a rotation and a translation). Metres, radians."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

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
        return float(self._turn_to(other).magnitude())

    def towards(self, other: Pose, share: float) -> Pose:
        """The frame after ``share`` of the way to the other, turning about one axis."""
        turn = (self._turn_to(other) ** share).as_matrix()
        return Pose(self.at + share * (other.at - self.at), self.axes @ turn)

    def _turn_to(self, other: Pose) -> Rotation:
        return Rotation.from_matrix(self.axes.T @ other.axes)


def turned_about(axis: Array, angle: float = 1.0) -> Array:
    """The rotation by ``angle`` times the length of ``axis`` about it."""
    return np.asarray(Rotation.from_rotvec(angle * axis).as_matrix(), dtype=np.float64)


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
    w, x, y, z = Rotation.from_matrix(axes).as_quat(canonical=True, scalar_first=True).tolist()
    return w, x, y, z


def axes_of(w: float, x: float, y: float, z: float) -> Array:
    """The rotation of a quaternion of any length but zero."""
    return np.asarray(Rotation.from_quat((w, x, y, z), scalar_first=True).as_matrix(), dtype=np.float64)
