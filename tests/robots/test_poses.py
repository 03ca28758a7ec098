from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.robots.standing import around
from pix2pred.structs.space.poses import (
    FloorPose,
    Pose,
    axes_of,
    quaternion_of,
    turned_about,
    turned_about_y,
    turned_about_z,
)

NUMBERS = st.floats(-5, 5)
FLOOR = st.builds(FloorPose, NUMBERS, NUMBERS, st.floats(-3, 3))


@given(FLOOR, FLOOR)
def test_floor_poses_are_a_group_that_frames_in_space_follow(a: FloorPose, b: FloorPose) -> None:
    back = a * (a.inverse * b)
    assert math.dist((back.x, back.y), (b.x, b.y)) < 1e-9 and back.turn_to(b) < 1e-9
    in_space = (Pose.on_floor(a) * Pose.on_floor(b)).floor
    together = a * b
    assert math.dist((in_space.x, in_space.y), (together.x, together.y)) < 1e-9
    assert in_space.turn_to(together) < 1e-9


@given(st.tuples(NUMBERS, NUMBERS, NUMBERS).filter(lambda v: np.linalg.norm(v) > 0.1), st.floats(-math.pi, math.pi))
def test_rotations_survive_quaternions(axis: tuple[float, float, float], angle: float) -> None:
    axes = turned_about(np.array(axis) / np.linalg.norm(axis), angle)
    assert np.allclose(axes_of(*quaternion_of(axes)), axes, atol=1e-9)


@given(st.floats(-math.pi, math.pi), st.floats(0, 1))
def test_the_way_between_two_frames_ends_in_them(angle: float, share: float) -> None:
    start = Pose(np.array([1.0, 2.0, 3.0]), turned_about_z(0.3))
    end = Pose(np.array([0.0, 2.0, 1.0]), turned_about_z(0.3) @ turned_about(np.array([1.0, 0.0, 0.0]), angle))
    assert start.towards(end, 1.0).angle_to(end) < 1e-6
    assert np.allclose(start.towards(end, 0.0).axes, start.axes)
    assert start.angle_to(start.towards(end, share)) == pytest.approx(share * abs(angle), abs=1e-6)


def test_looking_down_brings_the_x_axis_down() -> None:
    assert np.allclose(turned_about_y(math.pi / 2) @ [1, 0, 0], [0, 0, -1])
    assert np.allclose(Pose.looking((0, 0, 1), math.pi / 2, 0).axes[:, 0], [0, 1, 0])


def test_places_around_a_target_face_it_and_begin_with_the_nearest() -> None:
    here = FloorPose(-1.0, 0.0, 0.0)
    places = list(around((1.0, 0.0), here, (0.5, 0.7)))
    for place in places:
        dx, dy = 1.0 - place.x, -place.y
        assert math.cos(place.yaw) * dx + math.sin(place.yaw) * dy == pytest.approx(math.hypot(dx, dy))
    assert (places[0].x, places[0].y) == pytest.approx((0.3, 0.0))
    assert places[0].yaw == pytest.approx(0.0)
    assert len(places) == 48
