from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import pytest

from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger.environment import BurgerEnvironment
from pix2pred.domains.burger.vocabulary import SHARED, SKILL_OF, make_object
from pix2pred.domains.burger.world import BurgerWorld, Cell, Heading, Thing
from pix2pred.structs import Action, Demo
from pix2pred.structs.environment import Step

Run = Callable[..., Step]


@pytest.fixture(scope="session")
def demos() -> Mapping[str, Sequence[Demo]]:
    """Rendered demonstrations of all families, made once."""
    domain = BurgerDomain()
    return {family: domain.demonstrations(family, 0) for family in domain.families}


@pytest.fixture
def kitchen() -> BurgerWorld:
    """Grill above the robot, board to its right, a bun with a patty on it to the left, lettuce and a patty below."""
    return BurgerWorld(
        "robot", Cell(2, 2), Heading.RIGHT, None,
        (
            Thing("grill", "grill", Cell(0, 2)), Thing("cutting_board", "cutting_board", Cell(2, 4)),
            Thing("bottom_bun1", "bottom_bun", Cell(2, 0)), Thing("patty1", "patty", Cell(2, 0), 1),
            Thing("lettuce1", "lettuce", Cell(4, 2)), Thing("patty2", "patty", Cell(4, 1)),
        ),
        7,
    )  # fmt: skip


def act(environment: BurgerEnvironment, skill: str, *names: str) -> Step:
    """Run a skill given by names."""
    types = environment.world.types()
    return environment.execute(Action(SKILL_OF[skill], tuple(make_object(n, types[n]) for n in ("robot", *names))))


@pytest.fixture
def episode(kitchen: BurgerWorld) -> BurgerEnvironment:
    return BurgerEnvironment(kitchen, SHARED, ())


@pytest.fixture
def run(episode: BurgerEnvironment) -> Run:
    """Run a skill of the robot in ``episode``."""
    return lambda skill, *names: act(episode, skill, *names)
