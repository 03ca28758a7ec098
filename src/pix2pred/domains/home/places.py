"""Where things are: in a bin, on a table, on the floor, in a hopper, in a marked region. Pure geometry."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
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


Place = tuple[float, float]


def apart(tries: Iterable[Sequence[float]], taken: list[Place], gap: float) -> Place:
    """The first of ``tries`` that is ``gap`` away from all ``taken``, else the furthest; it is added to these."""
    near = [(min((math.dist(t, other) for other in taken), default=1.0), float(t[0]), float(t[1])) for t in tries]
    _, x, y = next((one for one in near if one[0] >= gap), max(near, key=lambda one: one[0]))
    taken.append((x, y))
    return x, y


def reachable(thing: Thing) -> bool:
    """Whether the one who acts can reach the thing."""
    return math.hypot(thing.at[0], thing.at[1]) <= REACH


def in_bin(world: World, name: str, container: str) -> bool:
    """Whether a thing lies inside a bin, its middle not far above the rim."""
    if name == world.holding:
        return False
    at, bin_ = world.thing(name).at, world.thing(container)
    size = bin_size(bin_)
    return size.is_under(at, bin_.at) and 0 <= at[2] <= size.height + 0.03


def on_table(world: World, name: str, table: str) -> bool:
    """Whether a thing lies on a table."""
    if name == world.holding:
        return False
    at, under = world.thing(name).at, world.thing(table)
    size = table_size(under)
    return size.is_under(at, under.at) and size.height - 0.02 <= at[2] <= size.height + 0.3


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
