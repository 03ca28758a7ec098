"""What one sees of every object: phrases by which a person, or a model, knows in a picture which one is meant.

A name such as ``juice_cup`` says what an object is for, which no picture shows. A phrase says what it is, of a cup also
its colour, and where it stands at first only where that is needed to tell it from others.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pix2pred.domains.home.drawing.movables import BRIGHT_NAMES, bright_number
from pix2pred.domains.home.drawing.vessels import VESSELS, vessel_colour
from pix2pred.domains.home.world import SCENERY, Thing, World

_CALLED: Mapping[str, str] = {"tumbler": "clear cup"}
"""Kinds that are called otherwise; the others are called by their names."""

_BRIGHT_KINDS = ("ball", "block", "car", "book", "can", "tape")
"""Small things of a bright colour all over."""

_ROW = 0.25
"""Metres between two rows of things, seen from the one who acts."""


def described(world: World) -> World:
    """``world`` in which every object has a phrase of its own."""
    objects = [t for t in world.things if t.type != SCENERY]
    phrases = _told_apart(objects, [_kind, _coloured])
    for phrase, count in Counter(phrases.values()).items():
        if count > 1:
            alike = [t for t in objects if phrases[t.name] == phrase]
            phrases |= {t.name: place.format(phrase) for t, place in zip(alike, _places(alike), strict=True)}
    return world.with_thing(*(replace(t, seen_as=phrases[t.name]) for t in objects))


def _told_apart(objects: Sequence[Thing], ways: Sequence[Callable[[Thing], str]]) -> dict[str, str]:
    """The first of the ways to call a thing that no other thing shares, else the last."""
    phrases: dict[str, str] = {}
    for way in ways:
        called = {t.name: way(t) for t in objects}
        shared = Counter(called.values())
        for thing in objects:
            if thing.name not in phrases and (shared[called[thing.name]] == 1 or way is ways[-1]):
                phrases[thing.name] = called[thing.name]
    return phrases


def _kind(thing: Thing) -> str:
    return _coloured(thing) if _is_cup(thing) else _CALLED.get(thing.kind, thing.kind).replace("_", " ")


def _coloured(thing: Thing) -> str:
    called = _CALLED.get(thing.kind, thing.kind).replace("_", " ")
    if _is_cup(thing):
        return f"{vessel_colour(thing).name} {called}".strip()
    if thing.kind in _BRIGHT_KINDS:
        return f"{BRIGHT_NAMES[bright_number(np.random.default_rng(thing.look))]} {called}"
    return called


def _is_cup(thing: Thing) -> bool:
    return thing.kind in VESSELS and VESSELS[thing.kind].cup


def _places(things: Sequence[Thing]) -> list[str]:
    """Where each of some things stands among them, as seen by the one who acts, with ``{}`` for what it is."""
    rows: list[list[Thing]] = []
    for thing in sorted(things, key=lambda t: t.at[0]):
        if rows and thing.at[0] - rows[-1][0].at[0] < _ROW:
            rows[-1].append(thing)
        else:
            rows.append([thing])
    places = {}
    for depth, row in zip(_in_line(len(rows), "front", "back"), rows, strict=True):
        for side, thing in zip(_in_line(len(row), "left", "right"), sorted(row, key=lambda t: -t.at[1]), strict=True):
            places[thing.name] = depth.format(side)
    return [places[t.name] for t in things]


def _in_line(count: int, first: str, last: str) -> list[str]:
    """How to tell ``count`` things in a line: nothing for one, the ends and the middle of up to three, else numbers."""
    few = {1: ["{}"], 2: [f"{first} {{}}", f"{last} {{}}"], 3: [f"{first} {{}}", "middle {}", f"{last} {{}}"]}
    return few.get(count, [f"{{}} number {k + 1} from the {first}" for k in range(count)])
