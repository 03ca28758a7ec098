"""The frames of a simulated robot as it knows them itself: by its odometry, not by the room."""

from __future__ import annotations

from pix2pred.robots.simulator.body import SimulatedBody
from pix2pred.robots.simulator.messages import FEET, FLAT_BODY, HAND, ODOM, VISION
from pix2pred.robots.simulator.settings import BODY_FROM_PLACE
from pix2pred.structs.space.poses import FloorPose, Pose
from pix2pred.structs.space.surroundings import CameraMount


def known(body: SimulatedBody) -> dict[str, Pose]:
    """The frames seen from the body."""
    odom = body.odom_from_body.inverse
    feet = Pose.on_floor(FloorPose(), -float(BODY_FROM_PLACE.at[2]))
    return {ODOM: odom, VISION: odom, FLAT_BODY: Pose(), FEET: feet, HAND: BODY_FROM_PLACE.inverse * body.hand}


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
    return Pose() if name == "body" else known(body).get(name)
