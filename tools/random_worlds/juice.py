"""Worlds of any arrangement, for training and judging the offline reader: random rooms, both bodies, all things."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pix2pred.domains.home.drawing.room import STYLES
from pix2pred.domains.home.drawing.vessels import DRINKS
from pix2pred.domains.home.places import Region
from pix2pred.domains.home.world import Body, Thing, World
from pix2pred.domains.juice.families import DEMONSTRATED_FRUITS, JUICE_CUPS, NEW_FRUITS
from pix2pred.domains.juice.party import FREE_PLACES, JUICER_PLACES, PartyCup, PartyJuicer, lay_out
from pix2pred.domains.juice.scenes import JUICER, Cup, Plan, make_world
from pix2pred.domains.juice.skills import FULL
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Picture
from random_worlds.home_views import some_pictures

Rng = np.random.Generator

_FRUITS = (*DEMONSTRATED_FRUITS, *NEW_FRUITS)
_PARTIES = 0.5
"""The share of a robot's scenes with several juicers."""


def worlds_of_look(seed: int, look: int, per_look: int) -> list[World]:
    """``per_look`` arrangements of things in differently drawn scenes, apart from demonstrations and tasks."""
    rng = scene_generator(seed, Split.READER, look)
    body = Body.HUMAN if rng.random() < 0.5 else Body.ROBOT
    style = str(rng.choice(sorted(STYLES)))
    if body is Body.ROBOT and rng.random() < _PARTIES:
        return _parties(style, per_look, rng)
    kinds = [str(k) for k in rng.choice(JUICE_CUPS, size=int(rng.integers(2, 4)))]
    fruits = [str(k) for k in rng.permutation(_FRUITS)[: int(rng.integers(1, 4))]]
    base = make_world(_plan(kinds, fruits, rng), body, style, rng)
    return [_rearranged(base, kinds, fruits, rng) for _ in range(per_look)]


def _parties(style: str, count: int, rng: Rng) -> list[World]:
    """Arrangements of the same things on a buffet with two to five juicers."""
    fruits = [str(k) for k in rng.permutation(_FRUITS)[: int(rng.integers(2, 6))]]
    juicers = int(rng.integers(2, 6))
    most = min(11, len(FREE_PLACES) - len(fruits) + 2 * juicers)
    kinds = [str(k) for k in rng.choice((*JUICE_CUPS, "bowl", "bowl"), size=int(rng.integers(5, most + 1)))]
    places = [int(k) for k in rng.permutation(len(JUICER_PLACES))[:juicers]]
    worlds: list[World] = []
    for _ in range(count):
        under = [(k, region) for k in range(juicers) for region in Region]
        least = max(0, len(kinds) + len(fruits) - len(FREE_PLACES))
        number = int(rng.integers(least, 1 + min(len(under), len(kinds))))
        taken = [under[i] for i in rng.permutation(len(under))[:number]]
        kinds = [kinds[i] for i in rng.permutation(len(kinds))]
        vessels = [
            PartyCup(f"cup{i}", kind, under=taken[i] if i < len(taken) else None) for i, kind in enumerate(kinds)
        ]
        held = [fruits[i] if i < len(fruits) and rng.random() < 0.7 else None for i in rng.permutation(juicers)]
        inside = [rng.random() < 0.6 for _ in held]
        machines = [
            PartyJuicer(f if i else None, None if i else f, bool(rng.random() < 0.5), place)
            for f, i, place in zip(held, inside, places, strict=True)
        ]
        world = lay_out(machines, vessels, [f for f in fruits if f not in held], style, rng)
        first = worlds[0] if worlds else world
        looks = [replace(t, look=first.thing(t.name).look) for t in world.things]
        worlds.append(_with_drinks(replace(world.with_thing(*looks), room=first.room), rng))
    return worlds


def _plan(kinds: list[str], fruits: list[str], rng: Rng) -> Plan:
    places = [str(p) for p in rng.permutation(("juice", "waste", "aside", "aside"))]
    cups = {f"cup{i}": Cup(kind, places[i]) for i, kind in enumerate(kinds)} | {"bowl": Cup("bowl")}
    where = {f: float(rng.random()) for f in fruits}
    inside = [f for f in fruits if where[f] < 0.30]
    squeezed = [f for f in fruits if where[f] > 0.55]
    return Plan(cups, fruits, inside, squeezed, bool(rng.random() < 0.5), bool(rng.random() < 0.7))


def _rearranged(base: World, kinds: list[str], fruits: list[str], rng: Rng) -> World:
    """The same room and looks with everything elsewhere: a new scene is made and its looks are exchanged."""
    made = make_world(_plan(kinds, fruits, rng), base.body, base.style, rng)
    juicer = base.thing(JUICER)
    dx, dy = (juicer.at[i] - made.thing(JUICER).at[i] for i in (0, 1))
    things = [replace(t, look=base.thing(t.name).look, at=(t.at[0] + dx, t.at[1] + dy, t.at[2])) for t in made.things]
    world = replace(made, things=tuple(things), room=base.room)
    world = _with_drinks(world, rng)
    names = [t.name for t in (*world.of_type("container"), *world.of_type("movable_object"))]
    held = str(rng.choice(names)) if rng.random() < 0.35 else None
    return replace(world, holding=held, gaze=held or str(rng.choice([*names, JUICER])))


def _with_drinks(world: World, rng: Rng) -> World:
    """``world`` with its vessels empty or full of something."""
    squeezed = [t.kind for t in world.of_type("movable_object") if t.squeezed]
    return world.with_thing(*(_filled(c, squeezed, rng) for c in world.of_type("container")))


def _filled(container: Thing, squeezed: list[str], rng: Rng) -> Thing:
    """Empty, or with the juice of fruit that was squeezed here or elsewhere, or with another drink."""
    kind = rng.random()
    if kind < 0.40:
        return replace(container, contents=(), amount=0.0)
    others = [f for f in _FRUITS if f not in squeezed]
    if kind < 0.80 and squeezed:
        number = int(rng.integers(1, len(squeezed) + 1))
        contents = tuple(sorted(str(k) for k in rng.permutation(squeezed)[:number]))
    elif kind < 0.88 and others:
        contents = (str(rng.choice(others)),)
    else:
        contents = (str(rng.choice(sorted(DRINKS))),)
    return replace(container, contents=contents, amount=float(rng.uniform(FULL - 0.08, FULL + 0.06)))


_SHARES = {"frontleft_fisheye": 0.4, "frontright_fisheye": 0.4, "left_fisheye": 0.15, "right_fisheye": 0.15}
"""How often a camera's picture is taken; the one at the back sees nothing of the scene."""


def views(world: World) -> list[Picture]:
    """What a person sees, or the robot's hand camera and some of the others, drawn by the world's own seed."""
    return some_pictures(world, _SHARES)
