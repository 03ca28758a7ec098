"""What happens when somebody presses the switch: the machine finds the cups under its valves by itself."""

from __future__ import annotations

from pix2pred.domains.home.episode import SkillFailedError
from pix2pred.domains.home.places import Region, in_region
from pix2pred.domains.home.world import World
from pix2pred.domains.juice.skills import run_machine


def switched(world: World, juicer: str) -> World:
    """The world after the switch of ``juicer`` was pressed; the machine does nothing where it cannot run."""
    under = {
        region: [c.name for c in world.of_type("container") if in_region(world, c.name, juicer, region)]
        for region in Region
    }
    if not under[Region.JUICE] or not under[Region.WASTE]:
        return world
    try:
        return run_machine(world, juicer, under[Region.JUICE][0], under[Region.WASTE][0])
    except SkillFailedError:
        return world
