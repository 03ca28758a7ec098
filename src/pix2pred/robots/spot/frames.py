"""Poses as messages of the vendor's interface, and the places of frames in what it tells."""

from __future__ import annotations

from typing import Any

import numpy as np
from bosdyn.api import geometry_pb2
from bosdyn.client.frame_helpers import get_a_tform_b

from pix2pred.structs.space.poses import FloorPose, Pose, axes_of, quaternion_of

BODY, ODOM = "body", "odom"


def seen_from(tree: Any, frame: str, name: str) -> Pose:
    """Where the frame ``name`` is, seen from ``frame``. Raises ``ValueError`` when the tree lacks one of them."""
    found = get_a_tform_b(tree, frame, name)
    if found is None:
        raise ValueError(f"the robot tells no frame {name!r} seen from {frame!r}")
    q = found.rot
    return Pose(np.array([found.x, found.y, found.z]), axes_of(q.w, q.x, q.y, q.z))


def message(pose: Pose) -> Any:
    """A pose as a message."""
    w, x, y, z = quaternion_of(pose.axes)
    a, b, c = (float(v) for v in pose.at)
    return geometry_pb2.SE3Pose(
        position=geometry_pb2.Vec3(x=a, y=b, z=c), rotation=geometry_pb2.Quaternion(w=w, x=x, y=y, z=z)
    )


def floor_message(pose: FloorPose) -> Any:
    """A pose on the floor as a message."""
    return geometry_pb2.SE2Pose(position=geometry_pb2.Vec2(x=pose.x, y=pose.y), angle=pose.yaw)
