"""What is where on the coffee table, and what is hidden (method 10.3).

Metres and radians: x to the right, y away from the camera, z up. The robot is a gripper that comes from the left; its
``tilt`` turns it from pointing right (0) to pointing down (pi/2), its ``wrist`` turns it about its own axis. The jug
stands upright unless it is held; ``rot`` 0 has its handle on the left, where the gripper reaches it. Amounts of coffee
are in cups of middle size.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from pix2pred.domains.coffee.simulation.geometry import CUP_HEIGHT, FULL_JUG, GRIP, PLATE, SPOUT, TABLE_Z, Point, turned

TARGET_SHARE = 0.75
"""A cup is filled when it holds more than this share of its capacity."""


@dataclass(frozen=True, slots=True)
class Gripper:
    """The gripper: the point between its finger tips, its angles, and how far it is open (metres)."""

    at: Point
    tilt: float = 0.0
    wrist: float = 0.0
    fingers: float = 0.04


@dataclass(frozen=True, slots=True)
class Jug:
    """The jug by the centre of its base. ``level`` is hidden."""

    at: Point
    rot: float = 0.0
    held: bool = False
    level: float = 0.0


@dataclass(frozen=True, slots=True)
class Cup:
    """A cup by the centre of its base. ``current`` is hidden."""

    name: str
    x: float
    y: float
    capacity: float
    current: float = 0.0

    @property
    def target(self) -> float:
        """The amount above which it counts as filled."""
        return TARGET_SHARE * self.capacity

    @property
    def filled(self) -> bool:
        """Whether it holds more than its target."""
        return self.current > self.target

    @property
    def mouth(self) -> Point:
        """The middle of its rim."""
        return Point(self.x, self.y, TABLE_Z + CUP_HEIGHT[self.capacity])


@dataclass(frozen=True, slots=True)
class CoffeeWorld:
    """Everything the simulator knows. ``cups`` are sorted by name; ``look`` seeds how the scene is drawn."""

    robot: Gripper
    jug: Jug
    cups: tuple[Cup, ...]
    machine_on: bool = False
    look: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "cups", tuple(sorted(self.cups, key=lambda c: c.name)))

    @property
    def jug_in_machine(self) -> bool:
        """Whether the jug stands under the dispenser."""
        return not self.jug.held and self.jug.at.distance(PLATE) < 0.01

    @property
    def jug_tilt(self) -> float:
        """How far the jug leans to pour; it leans only with the gripper that holds it."""
        return self.robot.tilt if self.jug.held else 0.0

    @property
    def handle(self) -> Point:
        """Where a gripper that comes from the left would have to close to hold the jug by its handle."""
        if self.jug.held:
            return self.robot.at
        reach = -GRIP.x
        return Point(
            self.jug.at.x - reach * math.cos(self.jug.rot),
            self.jug.at.y - reach * math.sin(self.jug.rot),
            self.jug.at.z + GRIP.z,
        )

    @property
    def spout(self) -> Point:
        """The tip of the spout."""
        if not self.jug.held:
            return Point(
                self.jug.at.x + SPOUT.x * math.cos(self.jug.rot),
                self.jug.at.y + SPOUT.x * math.sin(self.jug.rot),
                self.jug.at.z + SPOUT.z,
            )
        return self.robot.at + turned(SPOUT - GRIP, self.robot.tilt)

    def cup(self, name: str) -> Cup:
        """The cup called ``name``. Raises ``KeyError`` when there is none."""
        for cup in self.cups:
            if cup.name == name:
                return cup
        raise KeyError(name)

    def with_cup(self, changed: Cup) -> CoffeeWorld:
        """This world with the cup of the same name replaced."""
        return replace(self, cups=tuple(changed if c.name == changed.name else c for c in self.cups))

    def types(self) -> dict[str, str]:
        """Type names of all objects by name."""
        fixed = {ROBOT_NAME: "robot", JUG_NAME: "jug", MACHINE_NAME: "coffee_machine"}
        return fixed | {c.name: "cup" for c in self.cups}

    def to_dict(self) -> dict[str, Any]:
        """A JSON-compatible description; ``from_dict`` reads it back."""
        robot, jug = self.robot, self.jug
        return {
            "robot": {"at": list(robot.at), "tilt": robot.tilt, "wrist": robot.wrist, "fingers": robot.fingers},
            "jug": {"at": list(jug.at), "rot": jug.rot, "held": jug.held, "level": jug.level},
            "machine_on": self.machine_on,
            "cups": [
                {"name": c.name, "x": c.x, "y": c.y, "capacity": c.capacity, "current": c.current} for c in self.cups
            ],
            "look": self.look,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> CoffeeWorld:
        """The world described by ``data``. Raises ``ValueError`` for what is not a coffee world."""
        try:
            robot, jug = data["robot"], data["jug"]
            world = cls(
                Gripper(Point(*map(float, robot["at"])), *(float(robot[k]) for k in ("tilt", "wrist", "fingers"))),
                Jug(Point(*map(float, jug["at"])), float(jug["rot"]), bool(jug["held"]), float(jug["level"])),
                tuple(
                    Cup(str(c["name"]), *(float(c[k]) for k in ("x", "y", "capacity", "current"))) for c in data["cups"]
                ),
                bool(data["machine_on"]),
                int(data["look"]),
            )
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
            raise ValueError(f"not a coffee simulator state: {type(error).__name__}: {error}") from error
        _check(world)
        return world


ROBOT_NAME, JUG_NAME, MACHINE_NAME = "robot", "jug", "coffee_machine"


def _check(world: CoffeeWorld) -> None:
    names = [*world.types(), *(c.name for c in world.cups)]
    if len(world.types()) != 3 + len(world.cups):
        raise ValueError(f"not a coffee simulator state: two objects share a name in {', '.join(sorted(names))}")
    robot, jug = world.robot, world.jug
    numbers = [*robot.at, robot.tilt, robot.wrist, robot.fingers, *jug.at, jug.rot, jug.level]
    numbers += [n for c in world.cups for n in (c.x, c.y, c.current)]
    if not all(math.isfinite(n) for n in numbers):
        raise ValueError("not a coffee simulator state: a number in it is not finite")
    for cup in world.cups:
        if cup.capacity not in CUP_HEIGHT:
            known = ", ".join(f"{c:g}" for c in CUP_HEIGHT)
            raise ValueError(f"not a coffee simulator state: {cup.name} has capacity {cup.capacity:g}, not {known}")
        if not 0 <= cup.current <= cup.capacity:
            raise ValueError(f"not a coffee simulator state: {cup.name} holds {cup.current:g} of {cup.capacity:g}")
    if not 0 <= jug.level <= FULL_JUG:
        raise ValueError(f"not a coffee simulator state: the jug holds {jug.level:g} of {FULL_JUG:g}")
