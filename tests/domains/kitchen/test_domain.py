"""The kitchen as the rest of the system sees it: pictures, boxes, demonstrations, tasks."""

from __future__ import annotations

import ctypes.util
import os
import subprocess
import sys
from functools import cache

import numpy as np
import pytest

from extras import need
from pix2pred.domains.kitchen import KitchenDomain
from pix2pred.domains.kitchen.scenes import KETTLE_PUSH, PUSH_ANGLE
from pix2pred.domains.kitchen.vocabulary import INITIAL, OBJECT_OF, OBJECTS
from pix2pred.structs import Demo
from pix2pred.structs.environment import SimulatedTask

pytestmark = need("mujoco", "gymnasium_robotics", extra="sim")


@cache
def demo() -> Demo:
    return KitchenDomain().demonstrations("boil", 0)[0]


@cache
def task() -> SimulatedTask:
    return KitchenDomain().tasks("boil", 0, 1)[0]


def test_a_demonstration_boils_the_kettle_on_the_back_left_burner() -> None:
    assert [str(a.skill.name) for a in demo().actions] == ["MoveAndTurnOnKnob", "PushKettleOntoBurner"]
    assert [a.params for a in demo().actions] == [(PUSH_ANGLE,), KETTLE_PUSH]
    assert set(demo().goal) <= demo().states[-1].given and not set(demo().goal) & demo().states[1].given
    assert str(demo().goal[0]) == "KettleBoiling(kettle, burner4, knob4)"


def test_running_an_action_from_the_start_visits_the_demonstration_again() -> None:
    starts = KitchenDomain().demonstration_starts("boil", 0)
    assert len(starts) == 3
    assert starts[0].task.initial == demo().states[0] and starts[0].task.goal == demo().goal
    environment = KitchenDomain().environment(starts[0].task, starts[0].simulator)
    environment.execute(demo().actions[0])
    assert environment.features() == demo().states[1].features


def test_every_object_of_the_first_state_has_a_box_of_its_own() -> None:
    boxes = demo().states[0].pictures[0].boxes
    assert set(boxes) == {o.name for o in OBJECTS}
    for name, box in boxes.items():
        assert 0 <= box.left < box.right <= 480 and 0 <= box.top < box.bottom <= 480, name
    assert boxes["burner3"].center[0] > boxes["burner4"].center[0]
    assert boxes["knob4"].center[1] < boxes["knob2"].center[1]


def test_the_kettle_hides_the_burner_it_stands_on() -> None:
    glowing, covered = demo().states[1].pictures[0], demo().states[2].pictures[0]
    pixels = glowing.image.pixels().astype(int)
    box = glowing.boxes["burner4"]
    seen = pixels[int(box.top) : int(box.bottom), int(box.left) : int(box.right)]
    assert ((seen[..., 0] > 150) & (seen[..., 1] < 100)).sum() > 50, "the burner glows red"
    visible = covered.boxes.get("burner4")
    assert visible is None or visible.width < 0.5 * box.width


def test_equal_seeds_give_equal_pixels_and_other_seeds_other_scenes() -> None:
    again = KitchenDomain().tasks("boil", 0, 1)[0]
    assert again.task.initial == task().task.initial and again.simulator == task().simulator
    other = KitchenDomain().tasks("boil", 1, 1)[0]
    assert other.simulator != task().simulator
    assert other.task.initial.pictures[0].image != task().task.initial.pictures[0].image


def test_features_need_no_picture_and_agree_with_the_state() -> None:
    environment = KitchenDomain().environment(task().task, task().simulator)
    assert environment.features() == task().task.initial.features
    for item, values in environment.features().items():
        assert len(values) == len(item.type.features) and np.isfinite(values).all()
    assert environment.features()[OBJECT_OF["kettle"]][0] > 0, "tests start on the right"


def test_nothing_hidden_is_given() -> None:
    assert {a.predicate for a in task().task.initial.given} <= set(INITIAL)
    assert {f for o in OBJECTS for f in o.type.features} == {"x", "y", "z", "angle", "qw", "qx", "qy", "qz"}


def test_states_of_another_simulator_are_refused() -> None:
    with pytest.raises(ValueError, match="kitchen state"):
        KitchenDomain().environment(task().task, {"world": 1})
    with pytest.raises(ValueError, match="no family"):
        KitchenDomain().vocabulary("fry")


DRAW = """
from pix2pred.domains.kitchen.render import render
from pix2pred.domains.kitchen.world import standing_world
picture = render(standing_world(-0.27, 0.45))
print(len(picture.boxes), picture.image.pixels().std() > 20)
"""


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_drawing_works_with_both_backends_and_ends_quietly(backend: str) -> None:
    if backend == "osmesa" and ctypes.util.find_library("OSMesa") is None:
        if os.environ.get("PIX2PRED_NO_SKIPS") == "1":
            pytest.fail("libosmesa6 is not installed; .ci/run installs it")
        pytest.skip("needs the system package libosmesa6")
    result = _python(DRAW, MUJOCO_GL=backend)
    assert (result.returncode, result.stdout.split(), result.stderr) == (0, ["15", "True"], "")


def test_without_opengl_one_message_names_the_packages_and_the_physics_still_works() -> None:
    code = """
from pix2pred.domains.physics import OpenGLMissingError
from pix2pred.domains.kitchen.environment import KitchenEnvironment
from pix2pred.domains.kitchen.scenes import boiling, turn_on
from pix2pred.domains.kitchen.world import standing_world
environment = KitchenEnvironment(standing_world(-0.27, 0.45), boiling("4"))
print(environment.execute(turn_on("4")).status)
try:
    environment.observe()
except OpenGLMissingError as error:
    print(error)
"""
    result = _python(code, MUJOCO_GL="osmesa", PYOPENGL_PLATFORM="no-such-platform")
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("done") and "apt-get install libosmesa6" in result.stdout


def _python(code: str, **variables: str) -> subprocess.CompletedProcess[str]:
    kept = {k: v for k, v in os.environ.items() if k not in ("MUJOCO_GL", "PYOPENGL_PLATFORM")}
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, env=kept | variables, check=False
    )
