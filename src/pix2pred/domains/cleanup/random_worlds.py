"""Worlds of any arrangement, for training and judging the offline reader: random rooms, both bodies, all things."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pix2pred.domains.cleanup.scenes import (
    DEMONSTRATED_KINDS,
    FLOOR,
    NARROW,
    NEW_KINDS,
    OTHER,
    TABLE,
    WIDE,
    CleanupScene,
    arranged,
    make_world,
)
from pix2pred.domains.cleanup.skills import all_strokes
from pix2pred.domains.home.cameras import camera_names, some_pictures
from pix2pred.domains.home.drawing.room import STYLES
from pix2pred.domains.home.world import Body, World
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Picture

Rng = np.random.Generator


def worlds_of_look(seed: int, look: int, per_look: int) -> list[World]:
    """``per_look`` arrangements of one differently drawn scene, apart from demonstrations and tasks."""
    rng = scene_generator(seed, Split.READER, look)
    body = Body.HUMAN if rng.random() < 0.5 else Body.ROBOT
    style = str(rng.choice(sorted(STYLES)))
    bins = (NARROW, OTHER, WIDE) if rng.random() < 0.4 else (NARROW, WIDE)
    kinds = [str(k) for k in rng.permutation((*DEMONSTRATED_KINDS, *NEW_KINDS))[: int(rng.integers(1, 5))]]
    things = dict.fromkeys((*kinds, "eraser"), FLOOR)
    world = make_world(CleanupScene(things, bins), body, style, rng)
    return [_rearranged(world, list(things), bins, rng) for _ in range(per_look)]


def _rearranged(world: World, things: list[str], bins: tuple[str, ...], rng: Rng) -> World:
    held = str(rng.choice(things)) if rng.random() < 0.35 else None
    most_on_table = int(rng.choice((0, 0, 1, 1, 2, 9)))
    places: dict[str, str] = {}
    for name in rng.permutation(things):
        on_table = sum(p == TABLE for p in places.values())
        free = on_table < most_on_table and rng.random() < 0.6
        places[str(name)] = TABLE if free else str(rng.choice((FLOOR, FLOOR, *bins)))
    strokes = all_strokes() if rng.random() < 0.5 else ()
    world = world.with_thing(replace(world.thing(TABLE), strokes=strokes))
    lying = {n: p for n, p in places.items() if n != held}
    gaze = str(rng.choice([TABLE, *bins, *things]))
    return arranged(replace(world, holding=held, gaze=held or gaze), lying, rng)


def views(world: World) -> list[Picture]:
    """What a person sees, or the robot's hand camera and some of the others, drawn by the world's own seed."""
    return some_pictures(world, dict.fromkeys(camera_names(world), 0.4))
