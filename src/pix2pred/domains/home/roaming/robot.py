"""A robot that walks: a trunk with five cameras that moves as one, an arm of two links, and a camera in its hand."""

from __future__ import annotations

import math

import numpy as np

from pix2pred.domains.home.drawing.bodies import (
    ELBOW,
    GREY,
    HEIGHT,
    LOOKING_HAND,
    MOUNTS,
    SHOULDER,
    WIDTH,
    YELLOW,
    camera_axes,
    make_cameras,
    make_trunk,
    quaternion,
)
from pix2pred.domains.home.roaming.tags import make_tags
from pix2pred.domains.home.stage import PhysicalScene
from pix2pred.domains.home.world import vector
from pix2pred.domains.physics import Maker
from pix2pred.structs.space.poses import FloorPose, Pose, quaternion_of
from pix2pred.structs.space.surroundings import CameraMount

TRUNK, HAND, UPPER, FORE = "spot", "spot-hand", "spot-upperarm", "spot-forearm"
HAND_CAMERA = "hand_color"

_UPPER_LENGTH = math.dist(SHOULDER, ELBOW)
_FORE_LENGTH = math.dist(ELBOW, LOOKING_HAND)

_TO_OPTICAL = np.diag([1.0, -1.0, -1.0])
"""From right, up and backward to right, down and forward."""

_HAND_FOVY = next(m.fovy for m in MOUNTS if m.name == HAND_CAMERA)
_HAND_EYE = Pose(axes=np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]))
"""The hand's camera looks along the hand's x axis."""


def cameras() -> tuple[CameraMount, ...]:
    """The robot's cameras; those of the body are seen from the place on the floor under its nose."""
    found = []
    for m in MOUNTS:
        focal = HEIGHT / 2 / math.tan(math.radians(m.fovy) / 2)
        if m.name == HAND_CAMERA:
            found.append(CameraMount(m.name, WIDTH, HEIGHT, focal, _HAND_EYE, in_hand=True))
        else:
            axes = camera_axes(m.yaw, m.pitch, m.roll) @ _TO_OPTICAL
            found.append(CameraMount(m.name, WIDTH, HEIGHT, focal, Pose(np.array(m.at), axes)))
    return tuple(found)


def make_roaming_robot(maker: Maker) -> None:
    """The robot, whose parts are placed at run time, and tags on the walls."""
    make_tags(maker)
    trunk = maker.body(TRUNK)
    make_trunk(maker, trunk)
    make_cameras(maker, [m for m in MOUNTS if m.name != HAND_CAMERA], trunk)
    hand = maker.body(HAND)
    maker.camera(hand, HAND_CAMERA, (0, 0, 0), quaternion(camera_axes(0, 0, 0)), _HAND_FOVY)
    for name, long, radius, colour in ((UPPER, _UPPER_LENGTH, 0.035, YELLOW), (FORE, _FORE_LENGTH, 0.03, GREY)):
        maker.rod(f"body/{name}", radius, (0, 0, 0), (long, 0, 0), colour, body=maker.body(name))


def pose_robot(stage: PhysicalScene, base: FloorPose, hand: Pose) -> None:
    """Put the robot's parts where they are when its nose is over ``base`` and its hand at ``hand`` in the room.

    The elbow bends upward; a hand that is further than the arm is long leaves a gap at the wrist.
    """
    on_floor = Pose.on_floor(base)
    stage.move_fixture(TRUNK, vector(on_floor.at), quaternion_of(on_floor.axes))
    stage.move_fixture(HAND, vector(hand.at), quaternion_of(hand.axes))
    shoulder = on_floor.points(np.array(SHOULDER))
    along = hand.at - shoulder
    reach = min(max(float(np.linalg.norm(along)), 0.05), _UPPER_LENGTH + _FORE_LENGTH - 1e-6)
    cosine = (_UPPER_LENGTH**2 + reach**2 - _FORE_LENGTH**2) / (2 * _UPPER_LENGTH * reach)
    rise = math.acos(min(1.0, max(-1.0, cosine)))
    yaw = math.atan2(along[1], along[0])
    pitch = -math.atan2(along[2], math.hypot(along[0], along[1])) - rise
    upper = Pose.looking(shoulder.tolist(), yaw, pitch)
    elbow = upper.points(np.array([_UPPER_LENGTH, 0.0, 0.0]))
    rest = hand.at - elbow
    fore_pitch = -math.atan2(rest[2], math.hypot(rest[0], rest[1]))
    fore = Pose.looking(elbow.tolist(), math.atan2(rest[1], rest[0]), fore_pitch)
    for name, link in ((UPPER, upper), (FORE, fore)):
        stage.move_fixture(name, vector(link.at), quaternion_of(link.axes))
