"""How a Spot is worked with: deadlines, tolerances, the places of hand and body. Seconds, metres, radians."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pix2pred.structs.space.poses import FloorPose, Pose


@dataclass(frozen=True, slots=True)
class Deadlines:
    """How long is waited for an answer, and for a motion to end, before it counts as failed."""

    answer: float = 6.0
    """One call; the slowest pictures take two seconds over a busy radio link."""

    login: float = 10.0
    time_sync: float = 10.0
    power: float = 25.0
    stand: float = 12.0
    walk: float = 25.0
    """Five metres at a slow walk, with a turn."""

    arm: float = 30.0
    """A way over a whole table."""

    grasp: float = 45.0
    """Walking there included."""

    leaving: float = 8.0
    """Putting the arm away when everything else is over."""


@dataclass(frozen=True, slots=True)
class SpotSettings:
    """``poll`` is the time between two questions how a command is getting on."""

    deadlines: Deadlines = Deadlines()
    poll: float = 0.05
    estop_timeout: float = 9.0
    """Silence after which the robot settles and cuts its power; the vendor's examples use it."""

    near: float = 0.02
    near_angle: float = math.radians(1.0)
    """A walk is over when the tags put the robot so near to its goal: pictures then look as they should."""

    walks: int = 5
    """Times that a walk is corrected; drift of a tenth is gone after two."""

    blind: float = 1.5
    """Metres that may be walked by odometry alone when no tag is seen: with a drift of 5 % it is off by 8 cm then."""

    tag_size: float = 0.30
    """Side of the tags' black square where no map says it, in metres;
    the vendor's own tags measure 0.146."""

    reach: float = 1.10
    """From the shoulder to where the hand is sent; the arm is 0.98 long, and the body leans."""

    body_height: float = 0.58
    """Of the frame ``body`` over the floor when standing."""

    nose: float = 0.55
    """From the frame ``body`` to the place under the nose."""


HOME = FloorPose()
"""Where the robot looks at the scene from: where it stood when the map of tags was begun."""

LOOKING = Pose.looking((0.28, 0.0, 1.52), 0.0, math.radians(57))
"""The hand, seen from the place under the nose, when its camera looks down at the scene."""

SHOULDER = (-0.22, 0.0, 0.80)
"""Seen from the place under the nose."""

CAMERAS = (
    "frontleft_fisheye_image", "frontright_fisheye_image", "left_fisheye_image", "right_fisheye_image",
    "back_fisheye_image", "hand_color_image",
)  # fmt: skip
"""The six cameras of the published robot (method 10.6)."""

HAND_CAMERA = "hand_color_image"

FRONT = ("frontleft_fisheye_image", "frontright_fisheye_image", HAND_CAMERA)
"""Cameras whose distances are used to find where a thing is."""

DEPTH_OF = {
    "frontleft_fisheye_image": "frontleft_depth_in_visual_frame",
    "frontright_fisheye_image": "frontright_depth_in_visual_frame",
    "left_fisheye_image": "left_depth_in_visual_frame",
    "right_fisheye_image": "right_depth_in_visual_frame",
    "back_fisheye_image": "back_depth_in_visual_frame",
    HAND_CAMERA: "hand_depth_in_hand_color_frame",
}
"""Distances, pixel by pixel those of the colours."""
