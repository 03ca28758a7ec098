"""Where things are: in a bin, on a table, on the floor, in a hopper, in a marked region. Pure geometry."""

from __future__ import annotations

import math
from enum import Enum

from pix2pred.domains.home.drawing.fixtures import bin_size, table_size
from pix2pred.domains.home.drawing.vessels import (
    HOPPER_BOTTOM,
    HOPPER_RADIUS,
    HOPPER_TOP,
    JUICE_SIDE,
    REGION_FRONT,
    REGION_HALF,
    WASTE_SIDE,
)
from pix2pred.domains.home.world import Thing, World

REACH = 1.75
"""Metres from the one who acts to what can be reached, along the floor."""


class Region(Enum):
    """The two regions taped on the table, by where their middle lies left of the juicer's (metres)."""

    WASTE = WASTE_SIDE
    JUICE = JUICE_SIDE


def reachable(thing: Thing) -> bool:
    """Whether the one who acts can reach the thing."""
    return math.hypot(thing.at[0], thing.at[1]) <= REACH


def in_bin(world: World, name: str, container: str) -> bool:
    """Whether a thing lies inside a bin, its middle not far above the rim."""
    if name == world.holding:
        return False
    thing, bin_ = world.thing(name), world.thing(container)
    size = bin_size(bin_)
    dx, dy, z = abs(thing.at[0] - bin_.at[0]), abs(thing.at[1] - bin_.at[1]), thing.at[2]
    return dx <= size.half_x and dy <= size.half_y and 0 <= z <= size.height + 0.03


def on_table(world: World, name: str, table: str) -> bool:
    """Whether a thing lies on a table."""
    if name == world.holding:
        return False
    thing, under = world.thing(name), world.thing(table)
    size = table_size(under)
    dx, dy = abs(thing.at[0] - under.at[0]), abs(thing.at[1] - under.at[1])
    return dx <= size.half_x and dy <= size.half_y and size.height - 0.02 <= thing.at[2] <= size.height + 0.3


def things_on(world: World, table: str) -> tuple[str, ...]:
    """The movable things on a table."""
    return tuple(t.name for t in world.of_type("movable_object") if on_table(world, t.name, table))


def things_in(world: World, container: str) -> tuple[str, ...]:
    """The movable things in a bin."""
    return tuple(t.name for t in world.of_type("movable_object") if in_bin(world, t.name, container))


def on_floor(world: World, name: str) -> bool:
    """Whether a thing lies on the floor."""
    if name == world.holding or world.thing(name).at[2] > 0.2:
        return False
    return not any(in_bin(world, name, t.name) for t in world.of_type("trash_can"))


def in_hopper(world: World, name: str, juicer: str) -> bool:
    """Whether a fruit is in the juicer's hopper."""
    if name == world.holding or world.thing(name).squeezed:
        return False
    thing, machine = world.thing(name), world.thing(juicer)
    away = math.hypot(thing.at[0] - machine.at[0], thing.at[1] - machine.at[1])
    above = thing.at[2] - machine.at[2]
    return away < HOPPER_RADIUS and HOPPER_BOTTOM < above < HOPPER_TOP + 0.05


def hopper_contents(world: World, juicer: str) -> tuple[str, ...]:
    """The fruits in the juicer's hopper."""
    return tuple(t.name for t in world.of_type("movable_object") if in_hopper(world, t.name, juicer))


def region_middle(juicer: Thing, region: Region) -> tuple[float, float, float]:
    """The middle of a region on the table."""
    return juicer.at[0] + REGION_FRONT, juicer.at[1] + region.value, juicer.at[2]


def in_region(world: World, container: str, juicer: str, region: Region) -> bool:
    """Whether a vessel stands in a region."""
    if container == world.holding:
        return False
    x, y, _ = region_middle(world.thing(juicer), region)
    at = world.thing(container).at
    return abs(at[0] - x) <= REGION_HALF and abs(at[1] - y) <= REGION_HALF
