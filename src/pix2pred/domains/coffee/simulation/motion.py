"""One step of the simulator: the gripper moves a little, and the scene answers (method 10.3).

Everything is kinematic: a held jug follows the gripper, coffee flows while a jug leans over a cup, the machine fills
the jug under it while its button is pressed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pix2pred.domains.coffee.simulation.geometry import (
    BUTTON,
    CLOSED,
    CUP_RADIUS,
    FULL_JUG,
    GRIP,
    HIGH,
    JUG_HEIGHT,
    LOW,
    OPEN,
    PLATE,
    POUR_TILT,
    SPOUT,
    TABLE_Z,
    Point,
    turned,
)
from pix2pred.domains.coffee.world import CoffeeWorld, Cup

MAX_MOVE, MAX_TURN = 0.05, math.pi / 8
"""Limits of one step, in metres and radians."""

GRASP_TOLERANCE = 0.02
"""How close to the handle the fingers must close."""

POUR_RATE, FILL_RATE = 0.15, 0.5
"""Coffee that flows in one step, in cups of middle size."""


@dataclass(frozen=True, slots=True)
class Motion:
    """What the robot is told for one step: where to move towards, and how wide to open its fingers.

    ``tilt`` and ``wrist`` are the angles to turn towards; a closed hand over the jug turns the jug with its wrist.
    """

    to: Point
    tilt: float = 0.0
    wrist: float = 0.0
    fingers: float = OPEN


def pressing(world: CoffeeWorld) -> bool:
    """Whether the gripper presses the machine's button."""
    return world.robot.at.distance(BUTTON) < 0.015 and not world.jug.held


def twisting(world: CoffeeWorld) -> bool:
    """Whether the gripper has closed on the rim of the standing jug from above."""
    top = world.jug.at + Point(0, 0, JUG_HEIGHT)
    robot = world.robot
    return not world.jug.held and robot.tilt > 1.5 and robot.fingers <= CLOSED and robot.at.distance(top) < 0.02


def cup_below(world: CoffeeWorld) -> Cup | None:
    """The cup whose mouth the jug's spout is over, if any."""
    spout = world.spout
    for cup in world.cups:
        if math.hypot(spout.x - cup.x, spout.y - cup.y) < CUP_RADIUS[cup.capacity] and spout.z > cup.mouth.z:
            return cup
    return None


def pouring_over(world: CoffeeWorld) -> Cup | None:
    """The cup that the leaning jug is over, whether or not coffee still flows."""
    leans = world.jug.held and world.robot.tilt >= POUR_TILT - 1e-6
    return cup_below(world) if leans else None


def advance(world: CoffeeWorld, primitive: Motion) -> CoffeeWorld:
    """The world one step later."""
    was_twisting = twisting(world)
    moved = _moved(world, primitive)
    moved = _grasp_or_release(world, moved, primitive.fingers)
    if was_twisting and twisting(moved):
        jug = replace(moved.jug, rot=wrapped(moved.jug.rot + moved.robot.wrist - world.robot.wrist))
        moved = replace(moved, jug=jug)
    return _flow(moved)


def wrapped(angle: float) -> float:
    """``angle`` in (-pi, pi]."""
    return math.pi - (math.pi - angle) % (2 * math.pi)


def _moved(world: CoffeeWorld, primitive: Motion) -> CoffeeWorld:
    robot = world.robot
    goal = Point(*(min(max(v, lo), hi) for v, lo, hi in zip(primitive.to, LOW, HIGH, strict=True)))
    distance = robot.at.distance(goal)
    share = 1.0 if distance <= MAX_MOVE else MAX_MOVE / distance
    step = goal - robot.at
    at = goal if share == 1.0 else robot.at + Point(step.x * share, step.y * share, step.z * share)
    tilt = robot.tilt + _limited(primitive.tilt - robot.tilt)
    wrist = robot.wrist + _limited(primitive.wrist - robot.wrist)
    return _carried(replace(world, robot=replace(robot, at=at, tilt=tilt, wrist=wrist)))


def _limited(angle: float) -> float:
    return min(max(angle, -MAX_TURN), MAX_TURN)


def _carried(world: CoffeeWorld) -> CoffeeWorld:
    """A held jug hangs in the gripper; its place is where its base would stand if it were upright."""
    if not world.jug.held:
        return world
    return replace(world, jug=replace(world.jug, at=world.robot.at - GRIP, rot=0.0))


def _grasp_or_release(before: CoffeeWorld, now: CoffeeWorld, fingers: float) -> CoffeeWorld:
    closing = fingers <= CLOSED < before.robot.fingers
    opening = fingers > CLOSED >= before.robot.fingers
    now = replace(now, robot=replace(now.robot, fingers=fingers))
    if closing and abs(now.robot.tilt) < 0.1 and now.robot.at.distance(now.handle) < GRASP_TOLERANCE:
        return _carried(replace(now, jug=replace(now.jug, held=True)))
    if opening and now.jug.held:
        base = now.robot.at - GRIP
        over_plate = math.hypot(base.x - PLATE.x, base.y - PLATE.y) < 0.03 and base.z < PLATE.z + 0.04
        at = PLATE if over_plate else Point(base.x, base.y, TABLE_Z)
        return replace(now, jug=replace(now.jug, held=False, at=at))
    return now


def _flow(world: CoffeeWorld) -> CoffeeWorld:
    """The machine fills, the jug pours."""
    if pressing(world):
        world = replace(world, machine_on=True)
        if world.jug_in_machine:
            world = replace(world, jug=replace(world.jug, level=min(FULL_JUG, world.jug.level + FILL_RATE)))
    cup = pouring_over(world)
    if cup is None:
        return world
    amount = min(POUR_RATE, world.jug.level, cup.capacity - cup.current)
    poured = world.with_cup(replace(cup, current=cup.current + amount))
    return replace(poured, jug=replace(world.jug, level=world.jug.level - amount))


POURED_FROM = Point(0, 0, 0.045)
"""From the mouth of a cup to the spout that pours into it."""


def spout_over(cup: Cup) -> Point:
    """Where the gripper must be for the leaning jug's spout to be over the middle of the cup."""
    return cup.mouth + POURED_FROM - turned(SPOUT - GRIP, POUR_TILT)
