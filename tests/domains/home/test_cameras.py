from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from extras import need
from pix2pred.domains.cleanup.scenes import NARROW, TABLE, CleanupScene, make_world
from pix2pred.domains.home.cameras import LEAST_PIXELS, pictures
from pix2pred.domains.home.drawing.bodies import MOUNTS, camera_axes, quaternion
from pix2pred.domains.home.world import Body, World
from pix2pred.structs import Picture

pytestmark = [need("mujoco", extra="sim"), pytest.mark.usefixtures("drawing")]


def made(body: Body, seed: int = 0) -> World:
    plan = CleanupScene({"ball": TABLE, "eraser": NARROW}, gaze="ball")
    return make_world(plan, body, "home", np.random.default_rng(seed))


def by_camera(world: World) -> dict[str, Picture]:
    return {p.camera: p for p in pictures(world)}


def test_a_person_sees_everything_and_their_hand() -> None:
    (picture,) = pictures(made(Body.HUMAN))
    assert picture.image.size == (640, 480)
    assert set(picture.boxes) == {"ball", "eraser", "desk", "hand", "narrow_bin", "wide_bin"}


def test_the_robot_has_six_cameras_and_only_the_one_above_looks_into_a_narrow_bin() -> None:
    seen = by_camera(made(Body.ROBOT))
    assert list(seen) == [m.name for m in MOUNTS]
    assert [name for name, picture in seen.items() if "eraser" in picture.boxes] == ["hand_color"]
    assert all("robot" not in picture.boxes for picture in seen.values())


def test_what_the_robot_holds_is_in_no_picture_but_in_a_persons() -> None:
    held = {body: replace(made(body), holding="ball") for body in Body}
    assert all("ball" not in picture.boxes for picture in pictures(held[Body.ROBOT]))
    (picture,) = pictures(held[Body.HUMAN])
    ball, hand = picture.boxes["ball"], picture.boxes["hand"]
    assert ball.bottom > hand.top and ball.right > hand.left, "the hand is at the ball"


def test_pictures_are_turned_upright() -> None:
    world = made(Body.ROBOT)
    for name in ("frontleft_fisheye", "frontright_fisheye"):
        picture = by_camera(world)[name]
        width, height = picture.image.size
        assert height > width
        desk, ball = picture.boxes["desk"], picture.boxes.get("ball")
        if ball is not None:
            assert ball.bottom < desk.center[1], "things on the table are above its legs"


def test_a_picture_does_not_depend_on_what_was_drawn_before() -> None:
    world = made(Body.ROBOT)
    first = pictures(world)
    pictures(made(Body.HUMAN, 3))
    pictures(replace(world, holding="ball").with_thing(replace(world.thing("desk"), strokes=())))
    assert pictures(world) == first


def test_scribbles_show_and_belong_to_the_table() -> None:
    world = made(Body.HUMAN)
    wiped = world.with_thing(replace(world.thing("desk"), strokes=()))
    (before,), (after,) = pictures(world), pictures(wiped)
    assert before.boxes == after.boxes
    box = before.boxes["desk"]
    rows, columns = slice(int(box.top), int(box.bottom)), slice(int(box.left), int(box.right))
    change = np.abs(before.image.pixels()[rows, columns].astype(int) - after.image.pixels()[rows, columns]).max(axis=2)
    assert (change > 60).sum() > 20 * LEAST_PIXELS


def test_rooms_differ_by_seed() -> None:
    world = made(Body.HUMAN)
    assert pictures(world) != pictures(replace(world, room=world.room + 1))


@pytest.mark.parametrize("angles", [(0, 0, 0), (40, 20, 78), (-70, 22, 180), (180, 15, 0)])
def test_quaternions_are_the_rotations_of_their_axes(angles: tuple[float, float, float]) -> None:
    axes = camera_axes(*angles)
    assert np.allclose(axes @ axes.T, np.eye(3)) and np.isclose(np.linalg.det(axes), 1)
    w, x, y, z = quaternion(axes)
    rotated = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
    assert np.allclose(rotated, axes[:, 0], atol=1e-6)
