"""The frames of a simulated robot as it knows them itself, by its odometry and not by the room; and as messages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from bosdyn.api import geometry_pb2

from pix2pred.robots.simulator.body import SimulatedBody
from pix2pred.robots.simulator.settings import BODY_FROM_PLACE
from pix2pred.robots.spot.frames import BODY, ODOM, message
from pix2pred.structs.space.poses import FloorPose, Pose, axes_of
from pix2pred.structs.space.surroundings import CameraMount

HAND = "hand"


def known(body: SimulatedBody) -> dict[str, Pose]:
    """The frames seen from the body."""
    odom = body.odom_from_body.inverse
    feet = Pose.on_floor(FloorPose(), -float(BODY_FROM_PLACE.at[2]))
    hand = BODY_FROM_PLACE.inverse * body.hand
    return {ODOM: odom, "vision": odom, "flat_body": Pose(), "gpe": feet, HAND: hand}


def sensor(camera: CameraMount) -> str:
    """The name of a camera's frame."""
    return f"{camera.name}_image_sensor" if camera.in_hand else camera.name


def with_sensor(body: SimulatedBody, camera: CameraMount) -> dict[str, Pose]:
    """The frames, with that of a camera."""
    frames = known(body)
    frames[sensor(camera)] = (frames[HAND] if camera.in_hand else BODY_FROM_PLACE.inverse) * camera.pose
    return frames


def from_body(body: SimulatedBody, name: str) -> Pose | None:
    """A frame seen from the body; None for one that the robot does not know."""
    return Pose() if name == BODY else known(body).get(name)


def from_message(told: Any) -> Pose:
    """A pose in space; one without a rotation is not turned."""
    q, p = told.rotation, told.position
    axes = axes_of(q.w, q.x, q.y, q.z) if q.w or q.x or q.y or q.z else np.eye(3)
    return Pose(np.array([p.x, p.y, p.z]), axes)


def floor_from_message(told: Any) -> FloorPose:
    """A pose on the floor."""
    return FloorPose(told.position.x, told.position.y, told.angle)


def snapshot(seen_from_body: Mapping[str, Pose]) -> Any:
    """A tree of frames whose root is the body."""
    tree = geometry_pb2.FrameTreeSnapshot()
    tree.child_to_parent_edge_map[BODY].parent_frame_name = ""
    for name, pose in seen_from_body.items():
        edge = tree.child_to_parent_edge_map[name]
        edge.parent_frame_name = BODY
        edge.parent_tform_child.CopyFrom(message(pose))
    return tree
