from __future__ import annotations

import os
from collections.abc import Callable

import pytest

from pix2pred.domains.coffee.classifiers import AboveCup
from pix2pred.domains.coffee.environment import CoffeeEnvironment
from pix2pred.domains.coffee.simulation.geometry import HOME, TABLE_Z, Point
from pix2pred.domains.coffee.vocabulary import GIVEN, SKILL_OF, make_object
from pix2pred.domains.coffee.world import CoffeeWorld, Cup, Gripper, Jug
from pix2pred.structs import Action
from pix2pred.structs.environment import Step
from pix2pred.system.extras import MissingExtraError

Run = Callable[..., Step]


@pytest.fixture
def kitchen_table() -> CoffeeWorld:
    """Two cups, one small and one large, and a jug that can be picked up."""
    cups = (Cup("cup0", 0.65, 1.15, 0.75), Cup("cup1", 0.85, 1.2, 1.25))
    return CoffeeWorld(Gripper(HOME), Jug(Point(0.65, 1.43, TABLE_Z)), cups, look=7)


def act(environment: CoffeeEnvironment, skill: str, *names: str) -> Step:
    """Run a skill of the robot, given by names."""
    types = environment.world.types()
    return environment.execute(Action(SKILL_OF[skill], tuple(make_object(n, types[n]) for n in ("robot", *names))))


@pytest.fixture
def episode(kitchen_table: CoffeeWorld) -> CoffeeEnvironment:
    return CoffeeEnvironment(kitchen_table, GIVEN, (), AboveCup.ANYWHERE)


@pytest.fixture
def run(episode: CoffeeEnvironment) -> Run:
    """Run a skill of the robot in ``episode``."""
    return lambda skill, *names: act(episode, skill, *names)


@pytest.fixture(scope="session")
def drawing() -> None:
    """Skip without MuJoCo or without OpenGL to draw with; fail where nothing may be skipped."""
    from pix2pred.domains.coffee.simulation.render import render_pixels

    try:
        render_pixels(CoffeeWorld(Gripper(HOME), Jug(Point(0.65, 1.43, TABLE_Z)), ()))
    except MissingExtraError as error:
        if os.environ.get("PIX2PRED_NO_SKIPS") == "1":
            pytest.fail(str(error), pytrace=False)
        pytest.skip(str(error))
