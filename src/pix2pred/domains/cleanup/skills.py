"""The five skills: what they do, and why they fail (method 10.4)."""

from __future__ import annotations

import math
from dataclasses import replace

from pix2pred.domains.home.conditions import hand_is_empty, holds, within_reach
from pix2pred.domains.home.drawing.fixtures import STROKES, bin_size, stroke_points
from pix2pred.domains.home.episode import SkillFailedError
from pix2pred.domains.home.places import in_bin, on_floor, on_table, things_in, things_on
from pix2pred.domains.home.settling import free_spot, let_go, rise_of, settled, spilled
from pix2pred.domains.home.world import World

_WIPED_AROUND = 0.13
"""An eraser keeps this far from things that stand on the table (metres from their middle)."""

_DROP = 0.06
"""Height over the rim from which things are let go."""


def pick_from_top(world: World, name: str, surface: str) -> World:
    """Take a thing from a table, or out of a wide open bin. Fails for narrow bins: they have to be dumped."""
    hand_is_empty(world)
    under = world.thing(surface)
    if under.type == "table":
        if not on_table(world, name, surface):
            raise SkillFailedError(f"{name} does not lie on {surface}")
    else:
        if not in_bin(world, name, surface):
            raise SkillFailedError(f"{name} is not in {surface}")
        if not under.opened:
            raise SkillFailedError(f"the lid of {surface} is closed")
        if under.kind == "narrow_bin":
            raise SkillFailedError(f"{surface} is too narrow to reach into")
    return _taken(world, name)


def pick_from_floor(world: World, name: str) -> World:
    """Take a thing from the floor."""
    hand_is_empty(world)
    if not on_floor(world, name):
        raise SkillFailedError(f"{name} does not lie on the floor")
    return _taken(world, name)


def place_inside(world: World, name: str, container: str) -> World:
    """Let go of the held thing over a bin; physics says whether it stays inside."""
    holds(world, name)
    bin_ = world.thing(container)
    if not bin_.opened:
        raise SkillFailedError(f"the lid of {container} is closed")
    within_reach(world, container)
    size = bin_size(bin_)
    highest = max((world.thing(n).at[2] for n in things_in(world, container)), default=0.0)
    if highest > size.height - 0.02:
        raise SkillFailedError(f"{container} is full")
    x, y = free_spot(world, bin_)
    after = let_go(world, name, (x, y, size.height + rise_of(world.thing(name)) + _DROP))
    after = replace(after, gaze=container)
    if not in_bin(after, name, container):
        raise SkillFailedError(f"{name} did not come to rest inside {container}", after)
    return after


def wipe(world: World, name: str, table: str) -> World:
    """Wipe a table with the held eraser. Scribbles near things that stand on the table stay."""
    holds(world, name)
    if world.thing(name).kind != "eraser":
        raise SkillFailedError(f"{name} wipes nothing off")
    thing = world.thing(table)
    within_reach(world, table)
    in_the_way = things_on(world, table)
    left = tuple(s for s in thing.strokes if any(_near(world, table, s, other) for other in in_the_way))
    after = replace(world.with_thing(replace(thing, strokes=left)), gaze=table)
    if in_the_way:
        raise SkillFailedError(f"{in_the_way[0]} stands in the eraser's way on {table}", after)
    return after


def dump(world: World, container: str) -> World:
    """Lift a bin and tip its contents onto the floor."""
    hand_is_empty(world)
    bin_ = world.thing(container)
    contents = things_in(world, container)
    if not bin_.opened:
        raise SkillFailedError(f"the lid of {container} is closed")
    within_reach(world, container)
    if not contents:
        raise SkillFailedError(f"there is nothing in {container} to dump")
    after = replace(spilled(world, container), gaze=contents[0])
    stuck = [n for n in contents if in_bin(after, n, container)]
    if stuck:
        raise SkillFailedError(f"{stuck[0]} is stuck in {container}", after)
    return after


def all_strokes() -> tuple[int, ...]:
    """The scribbles of a table that nobody has wiped."""
    return tuple(range(STROKES))


def _near(world: World, table: str, stroke: int, other: str) -> bool:
    middle, at = world.thing(table).at, world.thing(other).at
    points = stroke_points(world.thing(table), stroke)
    return any(math.hypot(middle[0] + x - at[0], middle[1] + y - at[1]) < _WIPED_AROUND for x, y in points)


def _taken(world: World, name: str) -> World:
    within_reach(world, name)
    return settled(replace(world, holding=name, gaze=name), 0.4)
