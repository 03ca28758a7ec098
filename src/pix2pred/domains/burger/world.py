"""The grid world: what is where, what is hidden, and what primitive actions do (method 10.2).

Row 0 is the top of the picture, column 0 its left. The robot walks on the interior 3x3 cells; stations and items stand
on the edge. Coordinates are cells; z counts levels of a stack, 0 for whatever stands on the floor.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any

from pix2pred.domains.burger.vocabulary import ITEM, STATION, TYPE_OF

SIZE = 5
"""Cells along one side of the published kitchen; a family may have a larger one."""

MOST_SIZE = 15
"""Cells along one side of the largest kitchen: its pictures have 1920 pixels a side."""


class Heading(IntEnum):
    """Where the robot looks; the numbers are the values of its feature ``dir``."""

    UP = 0
    LEFT = 1
    DOWN = 2
    RIGHT = 3


@dataclass(frozen=True, slots=True, order=True)
class Cell:
    """A cell of the grid."""

    row: int
    col: int

    def toward(self, heading: Heading) -> Cell:
        """The neighbour in direction ``heading``, possibly outside the grid."""
        drow, dcol = _STEPS[heading]
        return Cell(self.row + drow, self.col + dcol)


_STEPS = {Heading.UP: (-1, 0), Heading.LEFT: (0, -1), Heading.DOWN: (1, 0), Heading.RIGHT: (0, 1)}


def edge_cells(size: int) -> tuple[Cell, ...]:
    """The edge cells of a kitchen that are not corners, row by row."""
    ends = (0, size - 1)
    return tuple(Cell(r, c) for r in range(size) for c in range(size) if (r in ends) != (c in ends))


EDGE_CELLS = edge_cells(SIZE)
"""The 12 of the published kitchen."""


@dataclass(frozen=True, slots=True)
class Thing:
    """A station or an item. ``prepared`` is hidden: a patty is cooked, a lettuce is sliced."""

    name: str
    type: str
    cell: Cell
    z: int = 0
    prepared: bool = False

    @property
    def is_item(self) -> bool:
        """Whether it can be picked up."""
        return TYPE_OF[self.type].is_a(ITEM)


@dataclass(frozen=True, slots=True)
class BurgerPrimitive:
    """One simulator step: at most one move, then a turn (-1 for none), then interact, then pick or place.

    ``toggle`` picks with an empty hand and places with a full one.
    """

    dcol: int = 0
    drow: int = 0
    turn: int = -1
    interact: bool = False
    toggle: bool = False

    @classmethod
    def move(cls, heading: Heading) -> BurgerPrimitive:
        """One cell in direction ``heading``."""
        drow, dcol = _STEPS[heading]
        return cls(dcol=dcol, drow=drow)


@dataclass(frozen=True, slots=True)
class BurgerWorld:
    """Everything the simulator knows. ``things`` are sorted by name; ``look`` seeds how the scene is drawn.

    ``size`` are the cells along one side of the kitchen.
    """

    robot: str
    cell: Cell
    heading: Heading
    held: str | None
    things: tuple[Thing, ...]
    look: int = 0
    size: int = SIZE

    def __post_init__(self) -> None:
        ordered = tuple(sorted(self.things, key=lambda t: t.name))
        object.__setattr__(self, "things", ordered)

    def thing(self, name: str) -> Thing:
        """The thing called ``name``. Raises ``KeyError`` when there is none."""
        for thing in self.things:
            if thing.name == name:
                return thing
        raise KeyError(name)

    def types(self) -> dict[str, str]:
        """Type names of all objects, the robot included, by name."""
        return {self.robot: "robot"} | {t.name: t.type for t in self.things}

    def where(self, name: str) -> Cell:
        """The cell of a thing or of the robot."""
        return self.cell if name == self.robot else self.thing(name).cell

    def walkable(self, cell: Cell) -> bool:
        """Whether the robot may stand in ``cell`` when nothing else does: in the interior."""
        return 0 < cell.row < self.size - 1 and 0 < cell.col < self.size - 1

    @property
    def faced(self) -> Cell:
        """The cell in front of the robot."""
        return self.cell.toward(self.heading)

    def stack(self, cell: Cell) -> tuple[Thing, ...]:
        """Whatever stands in ``cell``, lowest first; a held item is nowhere."""
        return tuple(sorted((t for t in self.things if t.cell == cell and t.name != self.held), key=lambda t: t.z))

    def supports(self, lower: str, upper: str) -> bool:
        """Whether item ``upper`` lies directly on ``lower``; never true of the robot or a held item."""
        if self.robot in (lower, upper) or upper == self.held:
            return False
        low, high = self.thing(lower), self.thing(upper)
        return low.cell == high.cell and high.z == low.z + 1 and high.is_item

    def cover(self, name: str) -> str | None:
        """The item directly on ``name``, if any."""
        return next((t.name for t in self.things if self.supports(name, t.name)), None)

    def changed(self, *changes: Thing) -> BurgerWorld:
        """This world with the things of the same names replaced."""
        table = {t.name: t for t in changes}
        return replace(self, things=tuple(table.get(t.name, t) for t in self.things))

    def to_dict(self) -> dict[str, Any]:
        """A JSON-compatible description; ``from_dict`` reads it back."""
        return {
            "robot": {"name": self.robot, "row": self.cell.row, "col": self.cell.col, "dir": int(self.heading)},
            "held": self.held,
            "things": [
                {"name": t.name, "type": t.type, "row": t.cell.row, "col": t.cell.col, "z": t.z, "prepared": t.prepared}
                for t in self.things
            ],
            "look": self.look,
            **({} if self.size == SIZE else {"size": self.size}),
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> BurgerWorld:
        """The world described by ``data``. Raises ``ValueError`` for what is not a burger world."""
        try:
            robot = data["robot"]
            things = tuple(
                Thing(t["name"], t["type"], Cell(int(t["row"]), int(t["col"])), int(t["z"]), bool(t["prepared"]))
                for t in data["things"]
            )
            world = cls(
                robot["name"], Cell(int(robot["row"]), int(robot["col"])), Heading(int(robot["dir"])),
                data["held"], things, int(data["look"]), int(data.get("size", SIZE)),
            )  # fmt: skip
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"not a burger simulator state: {type(error).__name__}: {error}") from error
        _check(world)
        return world


def _check(world: BurgerWorld) -> None:
    if not SIZE <= world.size <= MOST_SIZE:
        raise ValueError(f"not a burger simulator state: a kitchen has {SIZE} to {MOST_SIZE} cells a side")
    names = [world.robot, *(t.name for t in world.things)]
    if repeated := sorted({n for n in names if names.count(n) > 1}):
        raise ValueError(f"not a burger simulator state: {repeated[0]!r} is there twice")
    for thing in world.things:
        kind = TYPE_OF.get(thing.type)
        if kind is None or not (kind.is_a(ITEM) or kind.is_a(STATION)):
            raise ValueError(f"not a burger simulator state: {thing.name} has unknown type {thing.type!r}")
        if not (0 <= thing.cell.row < world.size and 0 <= thing.cell.col < world.size and thing.z >= 0):
            raise ValueError(f"not a burger simulator state: {thing.name} is outside the grid")
    if not world.walkable(world.cell):
        raise ValueError("not a burger simulator state: the robot is outside the interior cells")
    if world.held is not None and not (world.held in names[1:] and world.thing(world.held).is_item):
        raise ValueError(f"not a burger simulator state: {world.held!r} cannot be held")


def advance(world: BurgerWorld, primitive: BurgerPrimitive) -> BurgerWorld:
    """The world after one primitive action. Raises ``ValueError`` for a diagonal or longer move."""
    if abs(primitive.dcol) + abs(primitive.drow) > 1:
        raise ValueError(f"one cell along one axis at a time, not {primitive}")
    for heading, step in _STEPS.items():
        if step == (primitive.drow, primitive.dcol):
            world = _move(world, heading)
    if primitive.turn >= 0:
        world = replace(world, heading=Heading(primitive.turn))
    if primitive.interact:
        world = _interact(world)
    if primitive.toggle:
        world = _pick(world) if world.held is None else _place(world, world.thing(world.held))
    return world


def _move(world: BurgerWorld, heading: Heading) -> BurgerWorld:
    world = replace(world, heading=heading)
    if not world.walkable(world.faced) or world.stack(world.faced):
        return world
    world = replace(world, cell=world.faced)
    if world.held is None:
        return world
    return world.changed(replace(world.thing(world.held), cell=world.cell))


def _interact(world: BurgerWorld) -> BurgerWorld:
    def prepared(things: Iterable[Thing]) -> Iterable[Thing]:
        stations = {"patty": "grill", "lettuce": "cutting_board"}
        for lower in things:
            for upper in things:
                if world.supports(lower.name, upper.name) and stations.get(upper.type) == lower.type:
                    yield replace(upper, prepared=True)

    return world.changed(*prepared(world.stack(world.faced)))


def _pick(world: BurgerWorld) -> BurgerWorld:
    stack = world.stack(world.faced)
    if not stack or not stack[-1].is_item:
        return world
    top = stack[-1]
    return replace(world.changed(replace(top, cell=world.cell, z=1)), held=top.name)


def _place(world: BurgerWorld, held: Thing) -> BurgerWorld:
    stack = world.stack(world.faced)
    height = stack[-1].z + 1 if stack else 0
    return replace(world.changed(replace(held, cell=world.faced, z=height)), held=None)
