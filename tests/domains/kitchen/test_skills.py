"""The kitchen's physics: good pushes work, bad ones really fail, and nothing raises (method 10.1)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from extras import need
from pix2pred.domains.kitchen.arm import HOME
from pix2pred.domains.kitchen.environment import KitchenEnvironment
from pix2pred.domains.kitchen.scenes import LEFT, RIGHT, boiling, push_kettle, turn_on
from pix2pred.domains.kitchen.vocabulary import OBJECT_OF, PUSH_KETTLE, TURN_ON_KNOB
from pix2pred.domains.kitchen.world import KitchenWorld, standing_world
from pix2pred.structs import Action, Skill
from pix2pred.structs.environment import StepStatus

pytestmark = need("mujoco", "gymnasium_robotics", extra="sim")

GRIPPER, KETTLE = OBJECT_OF["gripper"], OBJECT_OF["kettle"]


def episode(x: float = LEFT, y: float = 0.45, number: str = "4", horizon: int = 4000) -> KitchenEnvironment:
    return KitchenEnvironment(standing_world(x, y), boiling(number), horizon)


@pytest.mark.parametrize(("x", "number"), [(LEFT, "4"), (RIGHT, "3")])
@pytest.mark.parametrize("y", [0.4, 0.55])
def test_turning_the_knob_and_pushing_the_kettle_makes_it_boil(x: float, y: float, number: str) -> None:
    environment = episode(x, y, number)
    for action in (turn_on(number), push_kettle(number)):
        assert not environment.goal_reached()
        assert environment.execute(action).status == StepStatus.DONE
    assert environment.goal_reached()
    assert np.linalg.norm(np.subtract(environment.features()[GRIPPER][:3], HOME)) < 0.05


def test_a_push_that_is_too_high_fails() -> None:
    environment = episode()
    step = environment.execute(push_kettle("4", (0.0, -0.2, 0.0, 0.0)))
    assert step.status == StepStatus.STUCK and "cm in y from burner4" in step.detail


def test_a_push_in_the_wrong_direction_misses_the_burner() -> None:
    environment = episode()
    step = environment.execute(push_kettle("4", (0.0, -0.2, -0.13, math.pi / 2)))
    assert step.status == StepStatus.STUCK and "from burner4" in step.detail


def test_a_push_away_from_the_knob_does_not_turn_it() -> None:
    environment = episode()
    step = environment.execute(turn_on("4", math.pi))
    assert step.status == StepStatus.STUCK and "radians only" in step.detail
    assert environment.features()[OBJECT_OF["knob4"]][3] > -0.1


BAD = {
    "not a number": push_kettle("4", (math.nan, 0.0, 0.0, 0.0)),
    "too few": push_kettle("4", (0.0,)),
    "none": Action(TURN_ON_KNOB, (GRIPPER, OBJECT_OF["knob4"])),
    "under the stove": push_kettle("4", (0.0, -0.2, -1.5, 0.0)),
    "far away": push_kettle("4", (5.0, 5.0, 5.0, 0.0)),
    "wrong objects": Action(PUSH_KETTLE, (GRIPPER, OBJECT_OF["knob1"], OBJECT_OF["burner1"]), (0, 0, 0, 0)),
    "too few objects": Action(TURN_ON_KNOB, (GRIPPER,), (0.3,)),
    "unknown skill": Action(Skill("Dance", ()), ()),
}


@pytest.mark.parametrize("action", BAD.values(), ids=list(BAD))
def test_what_cannot_work_is_an_outcome_with_its_cause(action: Action) -> None:
    environment = episode()
    step = environment.execute(action)
    assert step.status == StepStatus.STUCK and len(step.detail) > 20
    assert environment.execute(turn_on("4")).status == StepStatus.DONE, "the episode goes on"


def test_physics_that_diverges_is_an_outcome_and_leaves_a_sane_state() -> None:
    environment = episode()
    before = environment.world
    environment.data.qvel[:] = 1e9
    step = environment.execute(turn_on("4"))
    assert step.status == StepStatus.STUCK and "diverged" in step.detail
    assert environment.world == before
    assert environment.execute(turn_on("4")).status == StepStatus.DONE


def test_the_horizon_ends_a_skill_on_its_way() -> None:
    environment = episode(horizon=50)
    step = environment.execute(turn_on("4"))
    assert step.status == StepStatus.HORIZON and "50 commands" in step.detail


def test_a_skill_whose_end_is_reached_already_does_nothing() -> None:
    environment = episode()
    assert environment.execute(turn_on("4")).status == StepStatus.DONE
    before = environment.world
    assert environment.execute(turn_on("4")).status == StepStatus.DONE
    assert environment.world == before


def test_equal_episodes_are_equal_to_the_last_bit() -> None:
    ends = []
    for _ in range(2):
        environment = episode(RIGHT, 0.5, "3")
        environment.execute(push_kettle("3"))
        ends.append(environment.world)
    first = environment.world
    environment.reset()
    environment.execute(push_kettle("3"))
    assert ends[0] == ends[1] == first == environment.world


def test_a_state_survives_json_and_nothing_else_is_taken_for_one() -> None:
    world = standing_world(LEFT, 0.45)
    assert KitchenWorld.from_dict(world.to_dict()) == world
    for bad in ({}, {"positions": [1.0]}, {"positions": [math.inf] * 30}, {"positions": "x"}):
        with pytest.raises(ValueError, match="kitchen state"):
            KitchenWorld.from_dict(bad)
