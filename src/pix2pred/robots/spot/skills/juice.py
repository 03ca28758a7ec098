"""Juicing fruit: cups under two valves, fruit into the hopper, a lid and a switch (method 10.5)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pix2pred.robots.spot.robot import Spot
from pix2pred.robots.spot.skills.moving import (
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


@dataclass(frozen=True, slots=True)
class Machine:
    """A juicer's measures, as taken from the machine with a rule, from the middle of its foot (metres).

    ``front`` is where its foot begins. ``waste`` and ``juice`` are the regions taped on the table, ``lid`` the height
    of the closed lid, ``behind`` how far behind the middle an open lid stands, ``switch`` the switch in front.
    """

    front: float = -0.10
    waste: tuple[float, float] = (-0.05, 0.23)
    juice: tuple[float, float] = (-0.05, -0.23)
    lid: float = 0.37
    behind: float = 0.15
    switch: tuple[float, float, float] = (-0.092, 0.0, 0.09)


MACHINE = Machine()

CUP = 0.12
"""Metres over the table at which a hand lets go of a cup that stands: cups are held at their rims."""

DROP = 0.06
"""Metres over the hopper at which fruit is let go."""

POUR = math.radians(125)
"""How far a vessel is tilted to pour."""

POUR_HEIGHT = 0.20
"""Metres over the table at which a vessel pours into another."""


def _foot(spot: Spot, juicer: str) -> Array:
    """The middle of a juicer's foot, which faces the robot's home.

    From what is seen of its front: the pipes on both sides give the middle, the nearest of its foot the front.
    """
    seen = merged(spot.find(juicer)[juicer])
    heights = seen.points[:, 2]
    table = float(np.percentile(heights, 0.5))
    low, high = seen.extent()
    foot = seen.points[heights < table + 0.05]
    front = float(np.percentile(foot[:, 0], 5)) if len(foot) else float(low[0])
    return np.array([front - MACHINE.front, float(low[1] + high[1]) / 2, table])


def _place_at(offset: tuple[float, float, float]) -> Program:
    """The program that lets go of the held thing at ``offset`` from the middle of a juicer's foot."""

    def program(spot: Spot, name: str, juicer: str) -> None:
        holds(spot, name)
        let_go_at(spot, _foot(spot, juicer) + np.array(offset))

    return program


def pour(spot: Spot, source: str, target: str) -> None:
    """Tilt the held vessel over another one."""
    holds(spot, source)
    into = merged(spot.find(target)[target])
    x, y = into.middle()
    at = np.array([x, y, into.top + POUR_HEIGHT])
    stand_at(spot, (x, y), [at])
    yaw = facing(spot)
    level = down(at, yaw)
    axis = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
    spot.hand([level, Pose(at, turned_about(axis, POUR) @ level.axes), level])


def close_lid(spot: Spot, juicer: str) -> None:
    """Push the lid from behind until it lies on the hopper."""
    hand_is_empty(spot)
    lid = MACHINE.lid
    path = [(0, 0, lid + 0.35), (MACHINE.behind, 0, lid + 0.25), (0, 0, lid + 0.05), (0, 0, lid + 0.25)]
    _along(spot, _foot(spot, juicer) + np.array(path))


def run_machine(spot: Spot, juicer: str, juice_cup: str, waste_cup: str) -> None:
    """Press the switch with a finger."""
    hand_is_empty(spot)
    dx, dy, dz = MACHINE.switch
    before = (dx - 0.15, dy, dz)
    _along(spot, _foot(spot, juicer) + np.array([before, MACHINE.switch, before]))


def _along(spot: Spot, path: Array) -> None:
    stand_at(spot, path[0, :2], list(path))
    yaw = facing(spot)
    spot.hand([down(point, yaw) for point in path])


_PROGRAMS: Mapping[str, Program] = {
    "PickContainer": take,
    "PickMovable": take,
    "PlaceInsideWasteValveRegion": _place_at((*MACHINE.waste, CUP)),
    "PlaceInsideJuiceValveRegion": _place_at((*MACHINE.juice, CUP)),
    "PlaceInside": _place_at((0, 0, MACHINE.lid + DROP)),
    "DumpFromOneIntoOther": pour,
    "CloseLid": close_lid,
    "TurnOnAndRunMachine": run_machine,
}

REPERTOIRE = Repertoire(_PROGRAMS, {"container": "HoldingContainer", "movable_object": "HoldingObj"})
