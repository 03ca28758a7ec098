"""What physics decides: things let go of fall and come to rest, and a tipped bin spills what it holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from pix2pred.domains.home.drawing.fixtures import bin_size
from pix2pred.domains.home.drawing.movables import KINDS
from pix2pred.domains.home.places import things_in
from pix2pred.domains.home.stage import stage_for
from pix2pred.domains.home.world import UPRIGHT, Quaternion, Thing, Vector, World

_SPILL_TOWARDS = (0.58, 0.0)
"""The free floor in front of the one who acts."""

_LIFT = 0.42
"""How high the foot of a bin is lifted while it is tipped."""


def settled(world: World, seconds: float = 1.2) -> World:
    """The world at rest."""
    return stage_for(world).settle(world, seconds)


def let_go(world: World, name: str, at: Vector) -> World:
    """The thing, held or not, falls upright from ``at``."""
    return settled(replace(world.with_thing(replace(world.thing(name), at=at, turn=UPRIGHT)), holding=None))


def free_spot(world: World, container: Thing) -> tuple[float, float]:
    """The place over a bin that is furthest from what lies in it and from its walls."""
    size = bin_size(container)
    inside = [world.thing(n).at for n in things_in(world, container.name)]
    best, spot = -1.0, (container.at[0], container.at[1])
    for x in np.linspace(-0.55, 0.55, 5) * size.half_x:
        for y in np.linspace(-0.55, 0.55, 5) * size.half_y:
            place = (container.at[0] + float(x), container.at[1] + float(y))
            gap = min((math.dist(place, at[:2]) for at in inside), default=1.0) - 0.2 * math.hypot(x, y)
            if gap > best:
                best, spot = gap, place
    return spot


def rise_of(thing: Thing) -> float:
    """How high the middle of a movable thing lies above what it rests on."""
    return KINDS[thing.kind].rise


def spilled(world: World, container: str) -> World:
    """The world after a bin was lifted, tipped over and put back. Physics says where its contents come to rest."""
    bin_ = world.thing(container)
    x, y, _ = bin_.at
    dx, dy = _SPILL_TOWARDS[0] - x, _SPILL_TOWARDS[1] - y
    far = max(
        0.0, 1 - bin_size(bin_).height / (2 * math.hypot(dx, dy))
    )  # the mouth, not the foot, comes over the floor
    carried = shifted(world, (container, *things_in(world, container)), (far * dx, far * dy, _LIFT))
    foot, towards = carried.thing(container).at, math.atan2(dy, dx)
    stage = stage_for(carried)
    stage.pose(carried)
    for time in np.arange(0, 2.6, float(stage.model.opt.timestep)):
        shake = 0.12 * math.sin(20 * time) if 1.4 < time < 2.2 else 0.0
        angle = math.radians(158) * min(1.0, time / 1.3) + shake
        stage.move_fixture(container, foot, _tipped(towards, angle))
        stage.advance()
    poured = stage.moved(world)
    return settled(poured, 1.0)


def shifted(world: World, names: Sequence[str], by: Iterable[float]) -> World:
    """``world`` with some things further along by a vector."""
    dx, dy, dz = map(float, by)
    things = map(world.thing, names)
    return world.with_thing(*(replace(t, at=(t.at[0] + dx, t.at[1] + dy, t.at[2] + dz)) for t in things))


def _tipped(towards: float, angle: float) -> Quaternion:
    """A rotation by ``angle`` that leans towards the direction ``towards`` (radians)."""
    s = math.sin(angle / 2)
    return math.cos(angle / 2), -math.sin(towards) * s, math.cos(towards) * s, 0.0
