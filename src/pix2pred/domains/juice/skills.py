"""The eight skills: what they do, and why they fail (method 10.5)."""

from __future__ import annotations

from dataclasses import replace

from pix2pred.domains.home.conditions import hand_is_empty, holds, within_reach
from pix2pred.domains.home.drawing.movables import KINDS
from pix2pred.domains.home.drawing.vessels import HOPPER_RADIUS, HOPPER_TOP, RIND_PLACE
from pix2pred.domains.home.episode import SkillFailedError
from pix2pred.domains.home.places import Region, hopper_contents, in_hopper, in_region, region_middle
from pix2pred.domains.home.settling import let_go, rise_of
from pix2pred.domains.home.world import Thing, World

FULL = 0.9
"""The share of a vessel that is filled when it is full."""

MOST_FRUITS = 3
"""Fruits that the hopper takes."""


def take(world: World, name: str) -> World:
    """Take a thing; what is in a vessel stays in it."""
    hand_is_empty(world)
    within_reach(world, name)
    return replace(world, holding=name, gaze=name)


def pick_movable(world: World, name: str) -> World:
    """Take a fruit. What is in the hopper stays there."""
    for juicer in world.of_type("juicer"):
        if in_hopper(world, name, juicer.name):
            raise SkillFailedError(f"{name} is inside {juicer.name}")
    return take(world, name)


def place_in_region(world: World, name: str, juicer: str, *, region: Region) -> World:
    """Put the held vessel under a valve."""
    holds(world, name)
    machine = world.thing(juicer)
    within_reach(world, juicer)
    for other in world.of_type("container"):
        if other.name != name and in_region(world, other.name, juicer, region):
            raise SkillFailedError(f"{other.name} stands under the {region.name.lower()} valve already")
    at = region_middle(machine, region)
    return replace(world.with_thing(replace(world.thing(name), at=at)), holding=None, gaze=name)


def place_inside(world: World, name: str, juicer: str) -> World:
    """Let go of the held fruit over the open hopper."""
    holds(world, name)
    machine, fruit = world.thing(juicer), world.thing(name)
    if not machine.opened:
        raise SkillFailedError(f"the lid of {juicer} is closed")
    within_reach(world, juicer)
    if fruit.squeezed:
        raise SkillFailedError(f"{name} is squeezed already")
    if KINDS[fruit.kind].radius > HOPPER_RADIUS:
        raise SkillFailedError(f"{name} is too large for {juicer}")
    inside = hopper_contents(world, juicer)
    if len(inside) >= MOST_FRUITS:
        raise SkillFailedError(f"{juicer} is full")
    dx, dy = ((-0.035, 0.0), (0.03, 0.03), (0.03, -0.03))[len(inside)]
    x, y, z = machine.at
    after = let_go(world, name, (x + dx, y + dy, z + HOPPER_TOP + rise_of(fruit)))
    after = replace(after, gaze=juicer)
    if not in_hopper(after, name, juicer):
        raise SkillFailedError(f"{name} did not come to rest inside {juicer}", after)
    return after


def pour(world: World, source: str, target: str) -> World:
    """Pour what the held vessel holds into another one."""
    holds(world, source)
    poured, into = world.thing(source), world.thing(target)
    if not poured.contents:
        raise SkillFailedError(f"there is nothing in {source} to pour out")
    if into.contents:
        raise SkillFailedError(f"{target} is full")
    within_reach(world, target)
    emptied = replace(poured, contents=(), amount=0.0)
    filled = replace(into, contents=poured.contents, amount=poured.amount)
    return replace(world.with_thing(emptied, filled), gaze=target)


def close_lid(world: World, juicer: str) -> World:
    """Close the juicer's lid."""
    hand_is_empty(world)
    machine = world.thing(juicer)
    within_reach(world, juicer)
    if not machine.opened:
        raise SkillFailedError(f"the lid of {juicer} is closed already")
    return replace(world.with_thing(replace(machine, opened=False)), gaze=juicer)


def run_machine(world: World, juicer: str, juice_cup: str, waste_cup: str) -> World:
    """Juice whatever is in the hopper: juice into one cup, pulp into the other, the rinds onto the tray."""
    hand_is_empty(world)
    machine = world.thing(juicer)
    within_reach(world, juicer)
    if not machine.powered:
        raise SkillFailedError(f"{juicer} has no power")
    if machine.opened:
        raise SkillFailedError(f"the lid of {juicer} is open")
    fruits = hopper_contents(world, juicer)
    if not fruits:
        raise SkillFailedError(f"there is no fruit in {juicer}")
    for cup, region in ((juice_cup, Region.JUICE), (waste_cup, Region.WASTE)):
        if not in_region(world, cup, juicer, region):
            raise SkillFailedError(f"{cup} does not stand under the {region.name.lower()} valve of {juicer}")
        if world.thing(cup).contents:
            raise SkillFailedError(f"{cup} is full")
    juice = replace(world.thing(juice_cup), contents=tuple(sorted(world.thing(f).kind for f in fruits)), amount=FULL)
    pulp = replace(world.thing(waste_cup), contents=("pulp",), amount=FULL)
    return replace(world.with_thing(juice, pulp, *_rinds(world, machine, fruits)), gaze=juice_cup)


def _rinds(world: World, machine: Thing, fruits: tuple[str, ...]) -> list[Thing]:
    """The squeezed fruits, side by side on the tray."""
    x, y, z = machine.at
    lying = sum(t.squeezed and abs(t.at[1] - y) < 0.3 for t in world.of_type("movable_object"))
    places = [(x + RIND_PLACE[0] - 0.075 * (lying + i), y, z + 0.009) for i in range(len(fruits))]
    return [replace(world.thing(f), at=at, squeezed=True) for f, at in zip(fruits, places, strict=True)]
