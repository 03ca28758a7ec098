"""What is where in a room, who looks at it, and what a hand holds (method 10.4, 10.5).

Metres: x away from the one who acts, y to their left, z up. The one who acts stands at the origin and faces x.
Whatever moves lies where the physics left it; its place is the middle of its body.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from typing import Any

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


def vector(values: Iterable[float]) -> Vector:
    """Three numbers, of an array or otherwise, as a vector."""
    x, y, z = map(float, values)
    return x, y, z


UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)

SCENERY = "scenery"
"""The type of things that are no objects of the task, such as the counter under a juicer."""


class Body(StrEnum):
    """Who acts, and therefore whose eyes make the pictures."""

    HUMAN = "human"
    ROBOT = "robot"


ACTOR_NAME: Mapping[Body, str] = {Body.HUMAN: "hand", Body.ROBOT: "robot"}
"""What the object of type robot is called: of a person, only the hand is seen."""


@dataclass(frozen=True, slots=True)
class Thing:
    """An object of a scene. ``kind`` says what it looks like, ``look`` seeds its colours and size.

    The rest matters for some kinds: ``strokes`` of marker left on a table, ``contents`` and ``amount`` (share) of a
    container, ``opened`` lid, ``powered`` machine, ``squeezed`` fruit. ``seen_as`` is the phrase that picks it out in
    pictures.
    """

    name: str
    type: str
    kind: str
    look: int
    at: Vector = (0.0, 0.0, 0.0)
    turn: Quaternion = UPRIGHT
    strokes: tuple[int, ...] = ()
    contents: tuple[str, ...] = ()
    amount: float = 0.0
    opened: bool = True
    powered: bool = True
    squeezed: bool = False
    seen_as: str = ""


@dataclass(frozen=True, slots=True)
class World:
    """Everything the simulator knows. ``room`` seeds walls, floor, furniture and light; ``gaze`` is looked at."""

    things: tuple[Thing, ...]
    body: Body
    room: int = 0
    style: str = "home"
    gaze: str = ""
    holding: str | None = None
    _by_name: Mapping[str, Thing] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "things", tuple(sorted(self.things, key=lambda t: t.name)))
        object.__setattr__(self, "_by_name", {t.name: t for t in self.things})

    @property
    def actor(self) -> str:
        """The name of the object of type robot."""
        return ACTOR_NAME[self.body]

    def thing(self, name: str) -> Thing:
        """The thing called ``name``. Raises ``KeyError`` when there is none."""
        return self._by_name[name]

    def of_type(self, *types: str) -> tuple[Thing, ...]:
        """The things of these types, sorted by name."""
        return tuple(t for t in self.things if t.type in types)

    def with_thing(self, *changed: Thing) -> World:
        """This world with the things of the same names replaced."""
        new = {t.name: t for t in changed}
        return replace(self, things=tuple(new.get(t.name, t) for t in self.things))

    def types(self) -> dict[str, str]:
        """Type names of all objects by name."""
        return {self.actor: "robot"} | {t.name: t.type for t in self.things if t.type != SCENERY}

    def phrases(self) -> dict[str, str]:
        """What every object is called where pictures are talked about: its phrase, else its name."""
        said = {t.name: t.seen_as for t in self.things}
        return {name: said.get(name) or name.replace("_", " ") for name in self.types()}

    def to_dict(self) -> dict[str, Any]:
        """A JSON-compatible description; ``from_dict`` reads it back."""
        return {
            "things": [asdict(t) for t in self.things],
            "body": str(self.body),
            "room": self.room,
            "style": self.style,
            "gaze": self.gaze,
            "holding": self.holding,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> World:
        """The world described by ``data``. Raises ``ValueError`` for what is not such a world."""
        try:
            things = tuple(_thing(t) for t in data["things"])
            holding = None if data["holding"] is None else str(data["holding"])
            world = cls(things, Body(data["body"]), int(data["room"]), str(data["style"]), str(data["gaze"]), holding)
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
            raise ValueError(f"not a simulator state: {type(error).__name__}: {error}") from error
        _check(world)
        return world


def _thing(data: Mapping[str, Any]) -> Thing:
    a, b, c, d = map(float, data["turn"])
    return Thing(
        str(data["name"]),
        str(data["type"]),
        str(data["kind"]),
        int(data["look"]),
        vector(data["at"]),
        (a, b, c, d),
        tuple(map(int, data["strokes"])),
        tuple(map(str, data["contents"])),
        float(data["amount"]),
        bool(data["opened"]),
        bool(data["powered"]),
        bool(data["squeezed"]),
        str(data.get("seen_as", "")),  # worlds of older versions have none
    )


def _check(world: World) -> None:
    names = [t.name for t in world.things]
    if len(set(names)) < len(names) or world.actor in names:
        raise ValueError(f"not a simulator state: two objects share a name in {', '.join(names)}")
    for thing in world.things:
        if not all(map(math.isfinite, (*thing.at, *thing.turn, thing.amount))):
            raise ValueError(f"not a simulator state: a number of {thing.name} is not finite")
        if not 0 <= thing.amount <= 1:
            raise ValueError(f"not a simulator state: {thing.name} is filled to {thing.amount:g}")
        if not 0.5 < math.hypot(*thing.turn) < 2:
            raise ValueError(f"not a simulator state: {thing.name} is turned by no rotation")
    if world.holding is not None and world.holding not in names:
        raise ValueError(f"not a simulator state: {world.holding}, which is held, does not exist")


Machine = Callable[[World, str], World]
"""Gives the world after the switch of a machine was pressed."""


def no_machine(world: World, name: str) -> World:
    """A switch that does nothing."""
    return world
