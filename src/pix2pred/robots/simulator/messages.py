"""Poses and frames as messages of the protocol, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from bosdyn.api import geometry_pb2

from pix2pred.structs.space.poses import FloorPose, Pose, axes_of, quaternion_of

BODY, ODOM, VISION, FLAT_BODY, FEET, HAND = "body", "odom", "vision", "flat_body", "gpe", "hand"


def to_message(pose: Pose) -> Any:
    """A pose in space."""
    w, x, y, z = quaternion_of(pose.axes)
    at = [float(v) for v in pose.at]
    return geometry_pb2.SE3Pose(
        position=geometry_pb2.Vec3(x=at[0], y=at[1], z=at[2]), rotation=geometry_pb2.Quaternion(w=w, x=x, y=y, z=z)
    )


def from_message(message: Any) -> Pose:
    """A pose in space; one without a rotation is not turned."""
    q, p = message.rotation, message.position
    axes = axes_of(q.w, q.x, q.y, q.z) if q.w or q.x or q.y or q.z else np.eye(3)
    return Pose(np.array([p.x, p.y, p.z]), axes)


def floor_from_message(message: Any) -> FloorPose:
    """A pose on the floor."""
    return FloorPose(message.position.x, message.position.y, message.angle)


def snapshot(seen_from_body: Mapping[str, Pose]) -> Any:
    """A tree of frames whose root is the body."""
    tree = geometry_pb2.FrameTreeSnapshot()
    tree.child_to_parent_edge_map[BODY].parent_frame_name = ""
    for name, pose in seen_from_body.items():
        edge = tree.child_to_parent_edge_map[name]
        edge.parent_frame_name = BODY
        edge.parent_tform_child.CopyFrom(to_message(pose))
    return tree


def in_tree(tree: Any, name: str) -> Pose | None:
    """Where a frame of a tree is, seen from the tree's root; None when it is not in there."""
    pose, seen = Pose(), set[str]()
    while name in tree.child_to_parent_edge_map and name not in seen:
        seen.add(name)
        edge = tree.child_to_parent_edge_map[name]
        if not edge.parent_frame_name:
            return pose
        pose = from_message(edge.parent_tform_child) * pose
        name = edge.parent_frame_name
    return None


def seen_from(tree: Any, frame: str, name: str) -> Pose | None:
    """Where the frame ``name`` of a tree is, seen from ``frame``; None when one of them is not in there."""
    a, b = in_tree(tree, frame), in_tree(tree, name)
    return None if a is None or b is None else a.inverse * b
