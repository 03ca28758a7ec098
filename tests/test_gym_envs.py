"""Domains as gymnasium environments (extra ``gym``)."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from extras import need
from pix2pred.domains.kitchen.scenes import KETTLE_PUSH, PUSH_ANGLE

pytestmark = need("gymnasium", extra="gym")


@pytest.mark.parametrize(
    "name", ["Burger", pytest.param("Kitchen", marks=need("mujoco", "gymnasium_robotics", extra="sim"))]
)
def test_the_checker_finds_nothing(name: str) -> None:
    import gymnasium
    from gymnasium.utils.env_checker import check_env

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(f"pix2pred/{name}-v0", render_mode="rgb_array").unwrapped)


@need("mujoco", "gymnasium_robotics", extra="sim")
def test_the_demonstrators_skills_reach_the_goal() -> None:
    import gymnasium

    from pix2pred.gym_envs import DomainEnv

    made = gymnasium.make("pix2pred/Kitchen-v0", render_mode="rgb_array")
    env = made.unwrapped
    assert isinstance(env, DomainEnv)
    _, info = made.reset(seed=3)
    assert info["goal"] == ["KettleBoiling(kettle, burner3, knob3)"]
    wrong = made.step(env.action("MoveAndTurnOnKnob", ("kettle", "knob3"), (0.0,)))
    assert wrong[1:4] == (0.0, False, False) and "does not take" in wrong[4]["detail"]
    first = made.step(env.action("MoveAndTurnOnKnob", ("gripper", "knob3"), (PUSH_ANGLE,)))
    assert first[1:4] == (0.0, False, False) and first[4]["status"] == "done"
    last = made.step(env.action("PushKettleOntoBurner", ("gripper", "kettle", "burner3"), KETTLE_PUSH))
    assert last[1:4] == (1.0, True, False), last[4]
    assert np.array_equal(made.render(), last[0]["image"])


def test_what_cannot_be_drawn_is_refused() -> None:
    from pix2pred.gym_envs import DomainEnv

    with pytest.raises(ValueError, match="rgb_array"):
        DomainEnv("burger", render_mode="ascii")
