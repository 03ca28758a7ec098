from __future__ import annotations

import hashlib
import math
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from extras import need
from pix2pred.domains.coffee.simulation.geometry import CLOSED, FULL_JUG, GRIP, POUR_TILT, Point
from pix2pred.domains.coffee.simulation.render import render, render_pixels
from pix2pred.domains.coffee.world import CoffeeWorld, Gripper
from pix2pred.structs import Box, Picture

pytestmark = [need("mujoco", extra="sim"), pytest.mark.usefixtures("drawing")]

DIGEST = """
import hashlib
from pix2pred.domains.coffee.simulation.render import render_pixels
from pix2pred.domains.coffee.scenes import initial_world
from pix2pred.domains.seeds import Split, scene_generator
print(hashlib.sha256(render_pixels(initial_world(3, scene_generator(0, Split.TASKS, 3, 0))).tobytes()).hexdigest())
"""


def crop(picture: Picture, name: str) -> np.ndarray:
    box: Box = picture.boxes[name]
    return picture.image.pixels()[int(box.top) : int(box.bottom), int(box.left) : int(box.right)].astype(float)


def test_everything_has_a_box(kitchen_table: CoffeeWorld) -> None:
    assert set(render(kitchen_table).boxes) == {"robot", "jug", "coffee_machine", "cup0", "cup1"}


def test_the_lamp_shows_whether_the_machine_is_on(kitchen_table: CoffeeWorld) -> None:
    off, on = (render(replace(kitchen_table, machine_on=value)) for value in (False, True))
    assert off.boxes == on.boxes
    changed = np.abs(crop(on, "coffee_machine") - crop(off, "coffee_machine")).max(axis=2) > 40
    assert 100 < changed.sum() < 2000
    greener = crop(on, "coffee_machine")[changed][:, 1] - crop(off, "coffee_machine")[changed][:, 1]
    assert greener.mean() > 60


def test_fill_levels_show(kitchen_table: CoffeeWorld) -> None:
    for name, empty, full in (
        ("jug", kitchen_table, replace(kitchen_table, jug=replace(kitchen_table.jug, level=FULL_JUG))),
        ("cup0", kitchen_table, kitchen_table.with_cup(replace(kitchen_table.cup("cup0"), current=0.7))),
    ):
        before, after = render(empty), render(full)
        assert before.boxes == after.boxes
        assert (np.abs(crop(before, name) - crop(after, name)).max(axis=2) > 30).mean() > 0.15


def test_one_poured_cup_lowers_the_level_visibly(kitchen_table: CoffeeWorld) -> None:
    full, less = (render(replace(kitchen_table, jug=replace(kitchen_table.jug, level=v))) for v in (FULL_JUG, 6.15))
    assert (np.abs(crop(full, "jug") - crop(less, "jug")).max(axis=2) > 30).sum() > 100


@pytest.mark.parametrize("rotation", [60, -60, 120, -120])
def test_the_handle_shows_its_direction(kitchen_table: CoffeeWorld, rotation: float) -> None:
    reachable, away = (
        render(replace(kitchen_table, jug=replace(kitchen_table.jug, rot=math.radians(r)))) for r in (0, rotation)
    )
    # the handle sticks out to the left when it can be reached
    assert away.boxes["jug"].left > reachable.boxes["jug"].left + 8


def test_what_something_else_hides_has_no_box(kitchen_table: CoffeeWorld) -> None:
    hidden = replace(kitchen_table.cup("cup0"), x=0.99, y=1.75)
    assert "cup0" not in render(kitchen_table.with_cup(hidden)).boxes


def test_the_coffee_that_flows_belongs_to_no_object(kitchen_table: CoffeeWorld) -> None:
    from pix2pred.domains.coffee.simulation.motion import spout_over

    at = spout_over(kitchen_table.cup("cup1"))
    jug = replace(kitchen_table.jug, held=True, at=at - GRIP, level=3.0)
    pouring = replace(kitchen_table, robot=Gripper(at, POUR_TILT, 0.0, CLOSED), jug=jug)
    dry = replace(pouring, jug=replace(jug, level=0.0))
    assert render(pouring).boxes == render(dry).boxes
    assert (render_pixels(pouring) != render_pixels(dry)).any()


def test_a_picture_does_not_depend_on_what_was_drawn_before(kitchen_table: CoffeeWorld) -> None:
    first = render(kitchen_table)
    render(replace(kitchen_table, look=99, cups=kitchen_table.cups[:1], machine_on=True))
    render(replace(kitchen_table, robot=Gripper(Point(0.6, 1.2, 0.4), 1.0, 1.0, 0.03)))
    again = render(kitchen_table)
    assert first == again


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_another_process_draws_the_same_and_ends_in_silence(backend: str) -> None:
    environment = {k: v for k, v in os.environ.items() if k != "PYOPENGL_PLATFORM"} | {"MUJOCO_GL": backend}
    run = [
        subprocess.run([sys.executable, "-c", DIGEST], env=environment, capture_output=True, text=True, timeout=300)
        for _ in range(2)
    ]
    if "OpenGLMissingError" in run[0].stderr and os.environ.get("PIX2PRED_NO_SKIPS") != "1":
        pytest.skip(f"OpenGL by {backend} is not installed here")
    assert [r.returncode for r in run] == [0, 0], run[0].stderr
    assert [r.stderr for r in run] == ["", ""]
    assert run[0].stdout == run[1].stdout != hashlib.sha256(b"").hexdigest()
