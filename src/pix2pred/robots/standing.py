"""Where a robot can stand to reach something: places around it that face it, the nearest first."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from pix2pred.structs.space.poses import Array, FloorPose

STAND_OFF = (0.45, 0.60, 0.35, 0.75, 0.25)
"""Metres between the nose and what is worked at, as tried."""

DIRECTIONS = 24
"""Places tried around a target: every 15 degrees."""


def around(
    target: Sequence[float] | Array, here: FloorPose, distances: Sequence[float] = STAND_OFF
) -> Iterator[FloorPose]:
    """Places whose nose is at one of ``distances`` from ``target`` and points to it, the least way from ``here`` first.

    A turn by one radian counts as half a metre of way. Earlier distances are preferred where the way is the same.
    """
    x, y = float(target[0]), float(target[1])
    places = []
    for rank, distance in enumerate(distances):
        for k in range(DIRECTIONS):
            angle = 2 * math.pi * k / DIRECTIONS
            place = FloorPose(x - distance * math.cos(angle), y - distance * math.sin(angle), angle)
            way = here.distance(place) + 0.5 * here.turn_to(place)
            places.append((round(way, 6) + 0.05 * rank, rank, k, place))
    yield from (p for *_, p in sorted(places, key=lambda entry: entry[:3]))
