"""Clearing and wiping tables, filling and dumping bins (method 10.4)."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence

import numpy as np

from pix2pred.robots.spot.finding import Found
from pix2pred.robots.spot.limbs import FailedError
from pix2pred.robots.spot.robot import Spot
from pix2pred.robots.spot.skills.moving import (
    OVER,
    down,
    facing,
    hand_is_empty,
    holds,
    let_go_at,
    merged,
    stand_at,
    take,
)
from pix2pred.robots.spot.skills.repertoire import Program, Repertoire
from pix2pred.structs.space.poses import Array, Pose, turned_about

DROP = 0.10
"""Metres over the rim of a bin at which things are let go."""

STRIPE = 0.10
"""Metres between two stripes of the eraser, which is 15 centimetres long."""

ERASER = 0.055
"""Metres from the table's top to the hand that holds an eraser on it."""

SPILL = (0.58, 0.0)
"""The free floor in front of home onto which bins are dumped, in the map."""

LIFT = 0.30
"""Metres that a bin is lifted before it is tipped."""

TIP = math.radians(155)
"""How far a bin is tipped."""

SHAKES = 4
"""Times that it is shaken then, by ``SHAKE``."""

SHAKE = math.radians(14)


def pick_from_top(spot: Spot, name: str, surface: str) -> None:
    """Take a thing from a table."""
    take(spot, name)


def place_inside(spot: Spot, name: str, container: str) -> None:
    """Let go of the held thing over the place in a bin that is furthest from what lies in it and from its walls."""
    holds(spot, name)
    others = [o.name for o in spot.objects if o.type.name == MOVABLE and o.name != name]
    seen = spot.find(container, others=others)
    bin_ = merged(seen[container])
    x, y = _free_spot(bin_, [merged(seen[n]) for n in others if seen[n]])
    let_go_at(spot, np.array([x, y, bin_.top + DROP]))


def _free_spot(bin_: Found, things: Sequence[Found]) -> Array:
    """The best of a grid of places over a bin."""
    middle, (low, high) = bin_.middle(within=RIM), bin_.extent(within=RIM)
    half = (high - low) / 2
    inside = [t.middle() for t in things if np.all(np.abs(t.middle() - middle) <= half)]
    best, spot = -1.0, middle
    for share in itertools.product(np.linspace(-GRID, GRID, 5), repeat=2):
        off = half * np.array(share)
        gap = min((float(np.linalg.norm(middle + off - at)) for at in inside), default=1.0)
        gap -= 0.2 * float(np.linalg.norm(off))
        if gap > best:
            best, spot = gap, middle + off
    return spot


GRID = 0.5
"""Share of a bin's half width within which things are let go."""

MOVABLE = "movable_object"

RIM = 0.04
"""Metres under its top that belong to the rim of a bin or to the top of a table."""


def wipe(spot: Spot, name: str, table: str) -> None:
    """Go over the whole table with the held eraser: the left half and the right half, each from where it is reached."""
    holds(spot, name)
    top = merged(spot.find(table)[table])
    height = float(np.median(top.points[top.points[:, 2] >= top.top - RIM][:, 2]))
    low, high = top.extent(within=RIM)
    middle = (low[1] + high[1]) / 2
    for near, far in ((middle, high[1]), (low[1], middle)):
        path = _stripes((float(low[0]), float(near)), (float(high[0]), float(far)), height + ERASER)
        stand_at(spot, path.mean(axis=0)[:2], [*path, *(path[[0, -1]] + OVER)], HALF_TABLE)
        yaw = facing(spot)
        try:
            spot.hand([down(path[0] + OVER, yaw), *(down(p, yaw) for p in path), down(path[-1] + OVER, yaw)])
        except FailedError as error:
            raise FailedError(f"something stands in the eraser's way on {table} ({error})") from error


HALF_TABLE = (0.60, 0.75, 0.45, 0.90)
"""Metres between the nose and the middle of half a table, as tried."""


def _stripes(low: tuple[float, float], high: tuple[float, float], height: float) -> Array:
    """Corners of a path to and fro along x that covers a rectangle."""
    count = max(1, math.ceil((high[1] - low[1]) / STRIPE))
    points = []
    for k, y in enumerate(np.linspace(low[1], high[1], count + 1)):
        ends = (low[0], high[0]) if k % 2 == 0 else (high[0], low[0])
        points += [(x, float(y), height) for x in ends]
    return np.array(points)


def dump(spot: Spot, container: str) -> None:
    """Take a bin by the nearest part of its rim, tip it over that part onto the free floor, and put it back."""
    hand_is_empty(spot)
    seen = spot.find(container)[container]
    bin_ = merged(seen)
    middle = bin_.middle(within=RIM)
    wanted = _rim_point(seen[0], middle)
    spot.limbs.grasp(seen[0].shot, *seen[0].pixel_near(wanted))
    if not spot.session.state().manipulator_state.is_gripper_holding_item:
        raise FailedError(f"{container} is not in the hand")
    grip = spot.hand_at()
    if float(np.linalg.norm(grip - wanted)) > OFF_THE_RIM:
        spot.limbs.open_fingers()
        raise FailedError(f"{container} was taken beside the rim")
    out = grip[:2] - middle
    radius = float(np.linalg.norm(out))
    out = out / radius
    yaw = facing(spot)
    start = down(grip, yaw)
    lifted = down(grip + np.array([0, 0, LIFT]), yaw)
    hinge = np.array([*(np.array(SPILL) - 1.2 * radius * out), bin_.top + LIFT])
    over = down(hinge, yaw)
    axis = np.array([-out[1], out[0], 0.0])
    tips = [TIP] + [TIP + SHAKE * (-1) ** k for k in range(SHAKES)]
    try:
        spot.hand([lifted, over])
        spot.hand([Pose(over.at, turned_about(axis, angle) @ over.axes) for angle in (TIP / 2, *tips)])
        spot.hand([Pose(over.at, turned_about(axis, TIP / 2) @ over.axes), over, lifted, start])
    finally:
        spot.limbs.open_fingers()
    spot.hand([lifted])
    spot.limbs.close_fingers()


OFF_THE_RIM = 0.06
"""Metres between where a bin was to be taken and where it was, beyond which it is put down again."""


def _rim_point(bin_: Found, middle: Array) -> Array:
    """A point of the rim towards the free floor, with rim all around it: beside the rim, one looks past it."""
    rim = bin_.points[bin_.points[:, 2] >= bin_.top - RIM_THICKNESS]
    way = np.array(SPILL) - middle
    along = (rim[:, :2] - middle) @ (way / np.linalg.norm(way))
    near = rim[along >= np.percentile(along, 80)]
    across = np.abs((near[:, :2] - middle) @ np.array([-way[1], way[0]]) / np.linalg.norm(way))
    candidates = near[across <= max(0.04, float(across.min()) + 0.01)]
    around = [int((np.linalg.norm(rim - p, axis=1) < 0.012).sum()) for p in candidates]
    return np.asarray(candidates[int(np.argmax(around))])


RIM_THICKNESS = 0.015
"""Metres under its top at which the rim of a bin is still its rim."""


_PROGRAMS: Mapping[str, Program] = {
    "PickFromTop": pick_from_top,
    "PickFromFloor": take,
    "PlaceInside": place_inside,
    "WipeAndContinueHoldingEraser": wipe,
    "DumpContentsOntoFloor": dump,
}

REPERTOIRE = Repertoire(_PROGRAMS, {"movable_object": "Holding"})
