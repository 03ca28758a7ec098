"""What skills of the home domains need before they begin; where it is missing, the skill fails with the reason."""

from __future__ import annotations

from pix2pred.domains.home.episode import SkillFailedError
from pix2pred.domains.home.places import reachable
from pix2pred.domains.home.world import World


def hand_is_empty(world: World) -> None:
    """Raise ``SkillFailedError`` when the hand holds something."""
    if world.holding is not None:
        raise SkillFailedError(f"the hand already holds {world.holding}")


def holds(world: World, name: str) -> None:
    """Raise ``SkillFailedError`` when the hand does not hold the thing called ``name``."""
    if world.holding != name:
        raise SkillFailedError(f"{name} is not held" + (f", {world.holding} is" if world.holding else ""))


def within_reach(world: World, name: str) -> None:
    """Raise ``SkillFailedError`` when the thing called ``name`` is out of reach."""
    if not reachable(world.thing(name)):
        raise SkillFailedError(f"{name} is out of reach")
