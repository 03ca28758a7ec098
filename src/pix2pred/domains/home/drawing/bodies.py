"""Who looks: a person's head and hand, or a four-legged robot with six cameras mounted and turned as on a Spot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pix2pred.domains.physics import Maker

WIDTH, HEIGHT = 640, 480
"""Pixels of a picture as a camera takes it."""


@dataclass(frozen=True, slots=True)
class Mount:
    """A camera on the robot: where it is, where it looks, and how it is turned about its own axis (degrees).

    ``yaw`` to the left and ``pitch`` down from straight ahead. A picture is turned back by ``roll``, so that it is
    upright; the paper does the same. ``fovy`` is the vertical angle of the picture as taken.
    """

    name: str
    at: tuple[float, float, float]
    yaw: float
    pitch: float
    roll: float
    fovy: float


MOUNTS: Sequence[Mount] = (
    Mount("frontleft_fisheye", (-0.05, 0.07, 0.56), -20, 20, 78, 72),
    Mount("frontright_fisheye", (-0.05, -0.07, 0.56), 20, 20, 102, 72),
    Mount("left_fisheye", (-0.35, 0.16, 0.58), 70, 22, 0, 72),
    Mount("right_fisheye", (-0.35, -0.16, 0.58), -70, 22, 180, 72),
    Mount("back_fisheye", (-0.95, 0.0, 0.56), 180, 15, 0, 72),
    Mount("hand_color", (0.28, 0.0, 1.52), 0, 57, 0, 61),
)
"""The two front cameras cross: the one on the left looks to the right. The hand is raised and looks down."""

HEAD = (0.20, 0.0, 1.60)
"""A person's eyes, leaning forward a little."""

LEAN = 0.95
"""How far a person leans to the side of what they look at, as a share of its distance to that side."""

HEAD_FOVY = 57.0

YELLOW, BLACK, GREY = (0.93, 0.72, 0.10), (0.10, 0.10, 0.11), (0.35, 0.36, 0.38)


def camera_axes(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """The columns right, up and backward of a camera that looks ahead along x when all angles are 0 (degrees)."""
    a, b, c = (math.radians(v) for v in (yaw, pitch, roll))
    ahead = np.array([math.cos(a) * math.cos(b), math.sin(a) * math.cos(b), -math.sin(b)])
    right = np.array([math.sin(a), -math.cos(a), 0.0])
    up = np.cross(right, ahead)
    turned_right = math.cos(c) * right + math.sin(c) * up
    turned_up = -math.sin(c) * right + math.cos(c) * up
    return np.stack([turned_right, turned_up, -ahead], axis=1)


def quaternion(axes: np.ndarray) -> tuple[float, float, float, float]:
    """The rotation whose matrix is ``axes``."""
    m = axes
    w = math.sqrt(max(0.0, 1 + m[0, 0] + m[1, 1] + m[2, 2])) / 2
    x = math.copysign(math.sqrt(max(0.0, 1 + m[0, 0] - m[1, 1] - m[2, 2])) / 2, m[2, 1] - m[1, 2])
    y = math.copysign(math.sqrt(max(0.0, 1 - m[0, 0] + m[1, 1] - m[2, 2])) / 2, m[0, 2] - m[2, 0])
    z = math.copysign(math.sqrt(max(0.0, 1 - m[0, 0] - m[1, 1] + m[2, 2])) / 2, m[1, 0] - m[0, 1])
    return (w, x, y, z)


def eyes(target: Sequence[float]) -> tuple[float, float, float]:
    """Where the eyes of a person are who looks at ``target``."""
    return HEAD[0], LEAN * target[1], HEAD[2]


def gaze_angles(target: Sequence[float], eye: Sequence[float]) -> tuple[float, float]:
    """Yaw and pitch of a person who looks at ``target``."""
    dx, dy, dz = (t - e for t, e in zip(target, eye, strict=True))
    return math.degrees(math.atan2(dy, dx)), math.degrees(math.atan2(-dz, math.hypot(dx, dy)))


def make_person(maker: Maker) -> None:
    """A head with a camera, and the right hand: both are moved at run time. Only the hand is drawn."""
    head = maker.body("head")
    maker.camera(head, "head", (0, 0, 0), (1, 0, 0, 0), HEAD_FOVY)
    hand = maker.body("hand")
    skin, sleeve = (0.86, 0.64, 0.52), (0.20, 0.32, 0.50)
    maker.egg("hand/palm", (0.05, 0.042, 0.022), (0, 0, 0), skin, body=hand)
    for k, y in enumerate((-0.030, -0.010, 0.011, 0.030)):
        maker.rod(f"hand/finger{k}", 0.0095, (0.035, y, -0.002), (0.072, y * 1.1, -0.016), skin, body=hand)
        maker.rod(f"hand/tip{k}", 0.0085, (0.072, y * 1.1, -0.016), (0.078, y * 1.1, -0.044), skin, body=hand)
    maker.rod("hand/thumb", 0.011, (-0.005, 0.040, -0.008), (0.045, 0.058, -0.032), skin, body=hand)
    maker.rod("hand/wrist", 0.026, (-0.04, 0, 0), (-0.10, -0.01, 0.015), skin, body=hand)
    maker.rod("hand/sleeve", 0.042, (-0.13, -0.015, 0.025), (-0.45, -0.07, 0.12), sleeve, body=hand)


SHOULDER, ELBOW, LOOKING_HAND = (-0.22, 0.0, 0.80), (-0.15, 0.0, 1.30), (0.28, 0.0, 1.53)
"""Joints of the arm, and its end, when the hand camera looks down at the scene."""


def make_robot(maker: Maker) -> None:
    """A yellow body on four legs with an arm, made of our own simple shapes."""
    make_trunk(maker)
    maker.rod("body/upperarm", 0.035, SHOULDER, ELBOW, YELLOW)
    maker.rod("body/forearm", 0.03, ELBOW, LOOKING_HAND, GREY)
    make_cameras(maker, MOUNTS)


def make_trunk(maker: Maker, body: Any = None) -> None:
    """The robot without its arm, standing in the world or fixed to ``body``."""
    maker.slab("body/trunk", (0.42, 0.11, 0.085), (-0.55, 0, 0.58), YELLOW, body=body)
    maker.slab("body/back", (0.43, 0.075, 0.02), (-0.55, 0, 0.675), BLACK, body=body)
    for k, x in enumerate((-0.10, -1.0)):
        maker.slab(f"body/end{k}", (0.03, 0.10, 0.08), (x, 0, 0.58), BLACK, body=body)
    for k, (x, y) in enumerate(((-0.25, 0.17), (-0.25, -0.17), (-0.85, 0.17), (-0.85, -0.17))):
        maker.drum(f"body/hip{k}", 0.06, 0.05, (x, y * 0.85, 0.55), BLACK, body=body, quat=[0.7071, 0.7071, 0, 0])
        maker.rod(f"body/thigh{k}", 0.04, (x, y, 0.54), (x - 0.14, y, 0.30), YELLOW, body=body)
        maker.rod(f"body/shin{k}", 0.022, (x - 0.14, y, 0.30), (x - 0.02, y, 0.03), BLACK, body=body)
    maker.rod("body/shoulder", 0.05, (SHOULDER[0], 0, 0.70), SHOULDER, GREY, body=body)


def make_cameras(maker: Maker, mounts: Sequence[Mount], body: Any = None) -> None:
    """The robot's cameras, standing in the world or fixed to ``body``."""
    for mount in mounts:
        turn = quaternion(camera_axes(mount.yaw, mount.pitch, mount.roll))
        maker.camera(body or maker.world, mount.name, mount.at, turn, mount.fovy)


def hand_frame(eye: Sequence[float], yaw: float, pitch: float, out: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Where the hand is that a person holds before the eyes: a place and its axes, ``out`` right, down and ahead."""
    axes = camera_axes(yaw, pitch, 0)
    right, up, back = axes.T
    place = np.array(eye) + out[0] * right - out[1] * up - out[2] * back
    flat = camera_axes(yaw + 12, 12, 0)
    r, u, b = flat.T
    return place, np.stack([-b, -r, u], axis=1)
