"""Juicing fruit: cups under two valves, fruit into the hopper, a lid and a switch (method 10.5)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

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


@dataclass(frozen=True, slots=True)
class Juicer:
    """Where a juicer stands, in metres from the robot's home.

    ``x`` and ``y`` are the middle of its foot, ``table`` is the height of the table under it.
    """

    x: float
    y: float
    table: float

    def point(self, dx: float, dy: float, dz: float) -> Array:
        """A place given from the middle of its foot; it faces the robot's home."""
        return np.array([self.x + dx, self.y + dy, self.table + dz])


def _juicer(spot: Spot, name: str) -> Juicer:
    """From what is seen of its front: the pipes on both sides give the middle, the nearest of its foot the front."""
    seen = merged(spot.find(name)[name])
    heights = seen.points[:, 2]
    table = float(np.percentile(heights, 0.5))
    low, high = seen.extent()
    foot = seen.points[heights < table + 0.05]
    front = float(np.percentile(foot[:, 0], 5)) if len(foot) else float(low[0])
    return Juicer(front - MACHINE.front, float(low[1] + high[1]) / 2, table)


def place_in_waste_region(spot: Spot, name: str, juicer: str) -> None:
    """Put the held cup under the valve for the waste."""
    _place(spot, name, juicer, MACHINE.waste)


def place_in_juice_region(spot: Spot, name: str, juicer: str) -> None:
    """Put the held cup under the valve for the juice."""
    _place(spot, name, juicer, MACHINE.juice)


def place_inside(spot: Spot, name: str, juicer: str) -> None:
    """Let go of the held fruit over the hopper."""
    holds(spot, name)
    machine = _juicer(spot, juicer)
    at = machine.point(0, 0, MACHINE.lid + DROP)
    stand_at(spot, at[:2], [at, at + np.array([0, 0, OVER])])
    let_go_at(spot, at)


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
    machine = _juicer(spot, juicer)
    path = [
        machine.point(0, 0, MACHINE.lid + 0.35),
        machine.point(MACHINE.behind, 0, MACHINE.lid + 0.25),
        machine.point(0, 0, MACHINE.lid + 0.05),
        machine.point(0, 0, MACHINE.lid + 0.25),
    ]
    _along(spot, path)


def run_machine(spot: Spot, juicer: str, juice_cup: str, waste_cup: str) -> None:
    """Press the switch with a finger."""
    hand_is_empty(spot)
    machine = _juicer(spot, juicer)
    dx, dy, dz = MACHINE.switch
    before = machine.point(dx - 0.15, dy, dz)
    _along(spot, [before, machine.point(dx, dy, dz), before])


def _along(spot: Spot, path: list[Array]) -> None:
    stand_at(spot, path[0][:2], path)
    yaw = facing(spot)
    spot.hand([down(point, yaw) for point in path])


def _place(spot: Spot, name: str, juicer: str, region: tuple[float, float]) -> None:
    holds(spot, name)
    machine = _juicer(spot, juicer)
    at = machine.point(*region, CUP)
    stand_at(spot, at[:2], [at, at + np.array([0, 0, OVER])])
    let_go_at(spot, at)


_PROGRAMS: Mapping[str, Program] = {
    "PickContainer": take,
    "PickMovable": take,
    "PlaceInsideWasteValveRegion": place_in_waste_region,
    "PlaceInsideJuiceValveRegion": place_in_juice_region,
    "PlaceInside": place_inside,
    "DumpFromOneIntoOther": pour,
    "CloseLid": close_lid,
    "TurnOnAndRunMachine": run_machine,
}

REPERTOIRE = Repertoire(_PROGRAMS, {"container": "HoldingContainer", "movable_object": "HoldingObj"}, "HandEmpty")
