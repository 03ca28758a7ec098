"""The demonstrations and the test families (method 10.4, 11.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

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
    make_world,
)
from pix2pred.domains.home.domain import Recipe, Start, StartMaker
from pix2pred.domains.home.world import Body

Rng = np.random.Generator
_WIPED = f"WipedOfMarkerScribbles({TABLE})"
_WIPE = f"WipeAndContinueHoldingEraser(eraser, {TABLE})"


def _shown(name: str, plan: CleanupScene, skills: Sequence[str], goal: Sequence[str]) -> Recipe:
    return Recipe(name, partial(make_world, plan, Body.HUMAN, "home"), tuple(skills), tuple(goal))


def _inside(thing: str, container: str) -> str:
    return f"InsideContainer({thing}, {container})"


def _cleared(thing: str, container: str) -> list[str]:
    return [f"PickFromTop({thing}, {TABLE})", f"PlaceInside({thing}, {container})"]


def _dumped(thing: str, container: str) -> list[str]:
    return [f"DumpContentsOntoFloor({container})", f"PickFromFloor({thing})", f"PlaceInside({thing}, {WIDE})"]


RECIPES: Sequence[Recipe] = (
    _shown("wipe-0", CleanupScene({"ball": TABLE, "eraser": FLOOR}, gaze="ball"),
           [*_cleared("ball", WIDE), "PickFromFloor(eraser)", _WIPE], [_WIPED]),
    _shown("wipe-1", CleanupScene({"block": TABLE, "eraser": TABLE}, gaze="block"),
           [*_cleared("block", WIDE), f"PickFromTop(eraser, {TABLE})", _WIPE], [_WIPED, _inside("block", WIDE)]),
    _shown("wipe-2", CleanupScene({"car": TABLE, "eraser": FLOOR}, gaze="car"),
           [*_cleared("car", NARROW), "PickFromFloor(eraser)", _WIPE], [_WIPED]),
    _shown("wipe-3", CleanupScene({"book": TABLE, "eraser": FLOOR}, gaze="book"),
           [*_cleared("book", WIDE), "PickFromFloor(eraser)", _WIPE], [_WIPED]),
    _shown("dump-0", CleanupScene({"ball": NARROW, "bottle": NARROW, "block": NARROW, "book": OTHER, "car": OTHER},
                          (NARROW, OTHER, WIDE), scribbled=False, gaze=NARROW),
           [*_dumped("block", NARROW), *_dumped("car", OTHER)], [_inside("block", WIDE), _inside("car", WIDE)]),
    _shown("dump-1", CleanupScene({"block": NARROW, "car": OTHER}, (NARROW, OTHER, WIDE), scribbled=False, gaze=NARROW),
           [*_dumped("block", NARROW), *_dumped("car", OTHER)], [_inside("block", WIDE), _inside("car", WIDE)]),
)  # fmt: skip
"""Four times a table is cleared and wiped, twice narrow bins are dumped.

``wipe-1`` takes one of two things off the table, and ``dump-0`` spills three and then two things at once. Such
operators are pruned (method 5.5), so that the others have the printed numbers.
"""


def _some(kinds: Sequence[str], count: int, rng: Rng) -> list[str]:
    return [str(k) for k in rng.choice(kinds, size=count, replace=False)]


def _like_demonstrations(kinds: Sequence[str], style: str) -> StartMaker:
    """In turn: clear and wipe, dump and put elsewhere, wipe with the eraser in the way."""

    def start(index: int, rng: Rng) -> Start:
        (thing,) = _some(kinds, 1, rng)
        if index % 3 == 0:
            plan, goal = CleanupScene({thing: TABLE, "eraser": FLOOR}), [_WIPED]
        elif index % 3 == 1:
            plan, goal = CleanupScene({thing: NARROW, "eraser": TABLE}), [_inside(thing, WIDE)]
        else:
            plan, goal = CleanupScene({"eraser": TABLE, thing: FLOOR}), [_WIPED]
        return Start(make_world(plan, Body.ROBOT, style, rng), tuple(goal))

    return start


def _more_objects(index: int, rng: Rng) -> Start:
    things = _some((*NEW_KINDS, *DEMONSTRATED_KINDS), 3 + index % 2, rng)
    places = {t: TABLE if i < 2 else FLOOR for i, t in enumerate(things)}
    world = make_world(CleanupScene(places | {"eraser": FLOOR}), Body.ROBOT, "office", rng)
    return Start(world, tuple(_inside(t, WIDE) for t in things))


def _bin_after_wiping(index: int, rng: Rng) -> Start:
    (thing,) = _some(NEW_KINDS, 1, rng)
    world = make_world(CleanupScene({thing: FLOOR, "eraser": TABLE}), Body.ROBOT, "office", rng)
    return Start(world, (_WIPED, _inside("eraser", WIDE), _inside(thing, WIDE)))


def _eraser_in_bin(index: int, rng: Rng) -> Start:
    (thing,) = _some(NEW_KINDS, 1, rng)
    world = make_world(CleanupScene({thing: TABLE, "eraser": NARROW}), Body.ROBOT, "office", rng)
    return Start(world, (_WIPED, _inside("eraser", NARROW)))


def _many(index: int, rng: Rng) -> Start:
    """Two tables, three bins of which one is closed, thirteen things besides the eraser: put all of it away, wiped."""
    kinds = (*NEW_KINDS, *DEMONSTRATED_KINDS)
    names = [*_some(kinds, len(kinds), rng), *(f"{k}2" for k in _some(kinds, 3, rng))]
    places = dict.fromkeys(names, FLOOR) | {names[0]: TABLE, names[1]: SECOND_TABLE, names[2]: NARROW, "eraser": FLOOR}
    plan = CleanupScene(places, (NARROW, OTHER, WIDE), (OTHER,), 2, kinds={n: n.removesuffix("2") for n in names})
    world = make_world(plan, Body.ROBOT, "office", rng)
    wiped = f"WipedOfMarkerScribbles({SECOND_TABLE})"
    return Start(world, (_WIPED, wiped, *(_inside(n, WIDE) for n in (*names, "eraser"))))


FAMILIES: Mapping[str, StartMaker] = {
    "new-objects": _like_demonstrations(NEW_KINDS, "office"),
    "new-background": _like_demonstrations(DEMONSTRATED_KINDS, "studio"),
    "more-objects": _more_objects,
    "novel-goal-1": _bin_after_wiping,
    "novel-goal-2": _eraser_in_bin,
    "many": _many,
}
