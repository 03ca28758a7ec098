"""Worlds of any arrangement, for training and judging the offline reader: random rooms, both bodies, all things."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from pix2pred.domains.cleanup.scenes import (
    DEMONSTRATED_KINDS,
    FLOOR,
    NARROW,
    NEW_KINDS,
    OTHER,
    SECOND_TABLE,
    TABLE,
    WIDE,
    CleanupScene,
    arranged,
    make_world,
)
from pix2pred.domains.cleanup.skills import all_strokes
from pix2pred.domains.home.cameras import camera_names
from pix2pred.domains.home.drawing.room import STYLES
from pix2pred.domains.home.world import Body, World
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Picture
from random_worlds.home_views import some_pictures

Rng = np.random.Generator


_CROWDED = 0.55
"""The share of a robot's scenes with two tables, three bins and many things."""


@dataclass(frozen=True, slots=True)
class _Contents:
    """What the arrangements of a look have in common. ``things`` are kinds by name."""

    things: Mapping[str, str]
    bins: tuple[str, ...]
    tables: tuple[str, ...]


def worlds_of_look(seed: int, look: int, per_look: int) -> list[World]:
    """``per_look`` arrangements of one differently drawn scene, apart from demonstrations and tasks."""
    rng = scene_generator(seed, Split.READER, look)
    body = Body.HUMAN if rng.random() < 0.5 else Body.ROBOT
    style = str(rng.choice(sorted(STYLES)))
    crowded = body is Body.ROBOT and rng.random() < _CROWDED
    has = _crowd(rng) if crowded else _few(rng)
    plan = CleanupScene(dict.fromkeys(has.things, FLOOR), has.bins, tables=len(has.tables), kinds=has.things)
    world = make_world(plan, body, style, rng)
    return [_rearranged(world, has, rng) for _ in range(per_look)]


def _few(rng: Rng) -> _Contents:
    bins = (NARROW, OTHER, WIDE) if rng.random() < 0.4 else (NARROW, WIDE)
    kinds = [str(k) for k in rng.permutation((*DEMONSTRATED_KINDS, *NEW_KINDS))[: int(rng.integers(1, 5))]]
    return _Contents({k: k for k in (*kinds, "eraser")}, bins, (TABLE,))


def _crowd(rng: Rng) -> _Contents:
    """Six to fifteen things, some of a kind, and the eraser."""
    kinds = [str(k) for k in rng.permutation((*DEMONSTRATED_KINDS, *NEW_KINDS))[: int(rng.integers(5, 11))]]
    twice = {f"{k}2": k for k in kinds if rng.random() < 0.35}
    things = {k: k for k in (*kinds, "eraser")} | twice
    return _Contents(things, (NARROW, OTHER, WIDE), (TABLE, SECOND_TABLE))


def _rearranged(world: World, has: _Contents, rng: Rng) -> World:
    names = list(has.things)
    held = str(rng.choice(names)) if rng.random() < 0.35 else None
    places: dict[str, str] = {}
    most = {table: int(rng.choice((0, 0, 1, 1, 2, 9))) for table in has.tables}
    for name in rng.permutation(names):
        table = str(rng.choice(has.tables))
        on_table = sum(p == table for p in places.values())
        free = on_table < most[table] and rng.random() < 0.6
        places[str(name)] = table if free else str(rng.choice((FLOOR, FLOOR, *has.bins)))
    for table in has.tables:
        strokes = all_strokes() if rng.random() < 0.5 else ()
        world = world.with_thing(replace(world.thing(table), strokes=strokes))
    if len(has.tables) > 1:
        world = world.with_thing(replace(world.thing(OTHER), opened=bool(rng.random() < 0.5)))
        closed = not world.thing(OTHER).opened
        places = {n: FLOOR if closed and p == OTHER else p for n, p in places.items()}
    lying = {n: p for n, p in places.items() if n != held}
    gaze = str(rng.choice([*has.tables, *has.bins, *names]))
    return arranged(replace(world, holding=held, gaze=held or gaze), lying, rng)


def views(world: World) -> list[Picture]:
    """What a person sees, or the robot's hand camera and some of the others, drawn by the world's own seed."""
    return some_pictures(world, dict.fromkeys(camera_names(world), 0.4))
