"""The five skills as scripts of moves (method 10.3).

A skill makes its moves one after the other, each until nothing changes any more, and looks at the end whether its
purpose is fulfilled. Nothing checks preconditions: a skill started in the wrong situation moves all the same and fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.domains.coffee.simulation.geometry import (
    BUTTON,
    CLOSED,
    FULL_JUG,
    GRIP,
    HIGH,
    HOME,
    JUG_HEIGHT,
    LOW,
    OPEN,
    PLATE,
    POUR_TILT,
    TABLE_Z,
    Point,
)
from pix2pred.domains.coffee.simulation.motion import Motion, pressing, spout_over
from pix2pred.domains.coffee.vocabulary import SKILL_OF, TYPE_OF
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.domains.scripted import check_skill
from pix2pred.structs import Application

CARRY_Z = TABLE_Z + 0.1 + GRIP.z
"""Height of the gripper when it carries the jug over the cups."""

CARRY = Point(0.6, 1.42, CARRY_Z)
"""Where the gripper brings the jug that it picked, be it from the table or from the machine.

One place for both: otherwise the jug's place would tell whether it has been in the machine, which only its level shows.
"""

PICKABLE = 0.1
"""Largest angle of the jug at which its handle can be reached, in radians."""

_BACK = Point(-0.08, 0, 0)
_DOWNWARD = math.pi / 2


@dataclass(frozen=True, slots=True)
class Script:
    """A skill with its objects bound: its moves and when its purpose is fulfilled.

    ``stops`` tells that it ends as soon as that is the case, instead of making its last move to the end.
    """

    moves: tuple[Motion, ...]
    finished: Callable[[CoffeeWorld], bool]
    stops: bool = False


def script_for(skill: Application, world: CoffeeWorld) -> Script:
    """The script of ``skill``. Raises ``ValueError`` for an unknown skill, or objects that are absent or do not fit."""
    check_skill(skill, SKILL_OF, {name: TYPE_OF[t] for name, t in world.types().items()})
    match skill.name:
        case "PickJug":
            return Script(_pick(world), lambda w: w.jug.held)
        case "PlaceJugInMachine":
            return Script(_place(world), lambda w: w.jug_in_machine)
        case "TurnMachineOnAndFill":
            return Script(_turn_on(), lambda w: pressing(w) and w.jug_in_machine and w.jug.level >= FULL_JUG)
        case "PourSomeLiquid":
            cup = skill.args[2]
            return Script(_pour(world, cup), lambda w: w.cup(cup).filled, stops=True)
        case _:
            return Script(_rotate(world), handle_reachable)


def handle_reachable(world: CoffeeWorld) -> bool:
    """Whether a gripper that comes from the left finds the handle: the jug is upright and its handle on the left."""
    return abs(world.jug.rot) <= PICKABLE and abs(world.jug_tilt) < 0.1


def _pick(world: CoffeeWorld) -> tuple[Motion, ...]:
    grip = world.jug.at + GRIP
    lifted = grip + Point(0, 0, 0.012)
    way_out = (Motion(lifted + Point(-0.19, 0, 0), fingers=CLOSED),) if world.jug_in_machine else ()
    last = way_out[-1].to if way_out else lifted
    return (
        Motion(world.robot.at + _BACK),
        Motion(Point(grip.x - 0.08, grip.y, max(grip.z, min(world.robot.at.z, CARRY_Z)))),
        Motion(grip + _BACK),
        Motion(grip),
        Motion(grip, fingers=CLOSED),
        Motion(lifted, fingers=CLOSED),
        *way_out,
        Motion(Point(last.x, last.y, CARRY_Z), fingers=CLOSED),
        Motion(CARRY, fingers=CLOSED),
    )


def _place(world: CoffeeWorld) -> tuple[Motion, ...]:
    plate = PLATE + GRIP
    slightly_up = plate + Point(0, 0, 0.012)
    before = slightly_up + Point(-0.19, 0, 0)
    here = world.robot.at
    return (
        Motion(here, fingers=CLOSED),
        Motion(Point(here.x, here.y, max(here.z, CARRY_Z)), fingers=CLOSED),
        Motion(Point(before.x, before.y, CARRY_Z), fingers=CLOSED),
        Motion(before, fingers=CLOSED),
        Motion(slightly_up, fingers=CLOSED),
        Motion(plate, fingers=CLOSED),
        Motion(plate),
        Motion(plate + Point(-0.12, 0, 0)),
        Motion(HOME),
    )


def _turn_on() -> tuple[Motion, ...]:
    return Motion(BUTTON + _BACK, fingers=CLOSED), Motion(BUTTON, fingers=CLOSED)


def _pour(world: CoffeeWorld, cup: str) -> tuple[Motion, ...]:
    place = spout_over(world.cup(cup))
    here = world.robot.at
    return (
        Motion(here, fingers=CLOSED),
        Motion(Point(here.x, here.y, place.z), fingers=CLOSED),
        Motion(place, fingers=CLOSED),
        Motion(place, tilt=POUR_TILT, fingers=CLOSED),
    )


def _rotate(world: CoffeeWorld) -> tuple[Motion, ...]:
    top = world.jug.at + Point(0, 0, JUG_HEIGHT)
    over = top + Point(0, 0, 0.1)
    turn = world.robot.wrist - world.jug.rot
    return (
        Motion(Point(top.x, top.y, world.robot.at.z), tilt=_DOWNWARD, wrist=world.robot.wrist),
        Motion(over, tilt=_DOWNWARD, wrist=world.robot.wrist),
        Motion(top, tilt=_DOWNWARD, wrist=world.robot.wrist),
        Motion(top, tilt=_DOWNWARD, wrist=world.robot.wrist, fingers=CLOSED),
        Motion(top, tilt=_DOWNWARD, wrist=turn, fingers=CLOSED),
        Motion(top, tilt=_DOWNWARD, wrist=turn, fingers=OPEN),
        Motion(over, tilt=_DOWNWARD, wrist=turn),
        Motion(HOME),
    )


def explain(skill: Application, start: CoffeeWorld, end: CoffeeWorld) -> str:
    """Why ``skill``, started in ``start``, ended in ``end`` without its purpose fulfilled."""
    jug = start.jug
    match skill.name:
        case "PickJug":
            if not _reachable(jug.at + GRIP):
                return "the jug is out of the gripper's reach"
            if abs(jug.rot) > PICKABLE:
                return f"the jug's handle is turned away by {math.degrees(jug.rot):.0f} degrees"
            return "the fingers closed beside the handle"
        case "PlaceJugInMachine":
            return "the jug was not held" if not jug.held else "the jug did not come to stand under the dispenser"
        case "TurnMachineOnAndFill":
            if jug.held:
                return "the hand that should press the button held the jug"
            return "no jug stood under the dispenser" if not end.jug_in_machine else "the button was not reached"
        case "PourSomeLiquid":
            cup = start.cup(skill.args[2])
            if not jug.held:
                return "the jug was not held"
            if not _reachable(spout_over(cup)):
                return f"{cup.name} is out of the gripper's reach"
            return "the jug ran empty" if end.jug.level <= 0 else f"the spout did not come over {cup.name}"
        case _:
            return "the jug was in the hand" if jug.held else "the jug is out of the gripper's reach"


def _reachable(place: Point) -> bool:
    return all(lo <= v <= hi for v, lo, hi in zip(place, LOW, HIGH, strict=True))
