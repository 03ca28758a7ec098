"""How the simulated robot walks: around what stands there, as far as it is free, with drift or a velocity."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pix2pred.robots.simulator.settings import Traits
from pix2pred.robots.simulator.walking import Drift, Stands, Walk, drive, walk
from pix2pred.structs.space.poses import FloorPose

START = FloorPose()


def free(place: FloorPose) -> bool:
    return True


def post(x: float, y: float, radius: float = 0.1) -> Stands:
    """Whether no point of a body that is a metre long and behind its nose is at a post."""

    def stands(place: FloorPose) -> bool:
        here = place.inverse.point(x, y)
        return not (-1.0 - radius < here[0] < radius and abs(here[1]) < 0.2 + radius)

    return stands


def walked(goal: FloorPose, stands: Stands, drift: Drift | None = None) -> Walk:
    return walk(START, START, (goal,), 0.0, math.inf, drift or Drift(), Traits(), stands)


def test_a_free_way_is_straight_and_ends_at_its_goal() -> None:
    made = walked(FloorPose(1.2, 0.0, 0.0), free)
    assert made.clear == math.inf and made.lasts == pytest.approx(2.0)
    assert made.at(1.0)[0].x == pytest.approx(0.6)
    assert made.at(99.0) == (FloorPose(1.2, 0.0, 0.0), FloorPose(1.2, 0.0, 0.0))
    assert walked(START, free).at(0.1) == (START, START)


def test_a_turn_is_about_the_middle_of_the_body() -> None:
    middle = FloorPose(-0.55, 0.0, 0.0)
    made = walked(middle * FloorPose(yaw=math.pi / 2) * middle.inverse, free)
    half = made.at(made.lasts / 2)[1] * middle
    assert (half.x, half.y) == pytest.approx((-0.55, 0.0))
    assert half.yaw == pytest.approx(math.pi / 4)


def test_what_stands_on_the_straight_way_is_walked_around() -> None:
    stands = post(-0.2, 0.4)  # in the way of one who goes to the left and turns at once
    goal = FloorPose(0.3, 1.0, math.pi / 2)
    made = walked(goal, stands)
    assert made.clear == math.inf and len(made.true) > 2
    assert made.at(math.inf)[0] == goal
    assert all(stands(made.at(t)[1]) for t in np.linspace(0, made.lasts, 60))


def test_a_walk_with_no_way_around_ends_where_something_is_met() -> None:
    def wall(place: FloorPose) -> bool:
        return place.x < 0.5

    made = walked(FloorPose(1.0, 0.0, 0.0), wall)
    place = made.at(math.inf)[1]
    assert 0.4 < place.x < 0.5 and made.clear < made.lasts


def test_what_touches_a_robot_does_not_keep_it_from_leaving() -> None:
    assert walked(FloorPose(-1.0, 0.0, 0.0), post(0.05, 0.0)).clear == math.inf
    assert walked(FloorPose(0.02, 0.0, 0.0), post(0.05, 0.0)).clear == 0.0


def test_odometry_arrives_and_the_robot_is_beside_it() -> None:
    made = walked(FloorPose(1.0, 0.0, 0.0), free, Drift(0.05, 0.0, 0.02))
    felt, true = made.at(math.inf)
    assert felt == FloorPose(1.0, 0.0, 0.0)
    assert true.distance(START) == pytest.approx(1.05) and true.yaw == pytest.approx(0.02)


def test_a_velocity_means_what_it_says_at_any_pace() -> None:
    for pace in (1.0, 20.0):
        made = drive(START, START, FloorPose(0.5, 0.0, 0.0), 2.0, 0.0, Drift(), pace, free)
        assert made.lasts == pytest.approx(2.0 * pace)
        assert made.at(pace)[1].x == pytest.approx(0.5)
        assert made.at(math.inf)[1].x == pytest.approx(1.0)
    turned = drive(START, START, FloorPose(0.0, 0.0, 0.5), 2.0, 0.0, Drift(), 1.0, free).at(math.inf)[1]
    assert turned.yaw == pytest.approx(1.0)


def test_a_velocity_stops_where_something_stands() -> None:
    made = drive(START, START, FloorPose(0.5, 0.0, 0.0), 4.0, 0.0, Drift(), 1.0, post(1.0, 0.0))
    assert 0.8 < made.at(math.inf)[1].x < 0.9
