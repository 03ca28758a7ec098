"""What a hand on its way changes: an eraser wipes, a bin tips out, a vessel pours, a lid closes, a switch is pressed.

The world knows nothing of skills here: every effect follows from where the hand goes and what it holds.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.home.drawing.fixtures import bin_size, stroke_points, table_size
from pix2pred.domains.home.drawing.movables import KINDS
from pix2pred.domains.home.drawing.vessels import HOPPER_RADIUS, HOPPER_TOP, VESSELS
from pix2pred.domains.home.places import on_table
from pix2pred.domains.home.settling import settled, shifted
from pix2pred.domains.home.stage import stage_for
from pix2pred.domains.home.world import UPRIGHT, Machine, Thing, World, vector
from pix2pred.structs.space.poses import Array, Pose, axes_of, quaternion_of

SETTLING = 0.4
"""Seconds of physics after something was taken from a heap."""

STEP = 0.02
"""Metres, or radians times 0.1, between two places at which the effects of a moving hand are looked at."""

ERASER_REACH = 0.085
"""Metres from the middle of an eraser within which it wipes: it is 15 centimetres long."""

IN_THE_WAY = 0.10
"""Metres between the middles of an eraser and a thing at which they touch."""

TOUCHING = 0.05
"""How far the hand may be over a table and its eraser still wipes (metres)."""

POURING = math.radians(100)
"""From this tilt on a vessel pours."""

POURS_INTO = 0.07
"""Metres between the mouth of a vessel and the middle of the one it pours into."""

SWITCH = (-0.092, 0.0, 0.09)
"""Where the switch of a juicer is, from its foot."""

PRESSES = 0.035
"""Metres from a finger to a switch that it presses."""

CARRYING_SPEED, TURNING_SPEED = 0.4, 1.2
"""Metres and radians per second at which a bin is carried and tipped while physics runs."""


@dataclass(frozen=True, slots=True)
class Wielded:
    """A bin in the hand.

    ``seen_from_hand`` is its pose in the hand's frame, in metres.
    """

    name: str
    seen_from_hand: Pose


@dataclass(slots=True)
class Held:
    """What is remembered of the hand's work: how its axes were when it closed, and what an eraser has touched.

    A scribble is gone when all its points were touched, be it in several strokes; until then all of it shows.
    """

    axes: Array = field(default_factory=lambda: np.eye(3))
    touched: dict[tuple[str, int], NDArray[np.bool_]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Moved:
    """The world after the hand moved, and how many of the poses it was sent to it reached."""

    world: World
    reached: int


def pose_of(thing: Thing) -> Pose:
    """Where a thing is."""
    return Pose(np.array(thing.at), axes_of(*thing.turn))


def moved(world: World, wielded: Wielded | None, path: Sequence[Pose], held: Held, machine: Machine) -> Moved:
    """The hand goes from the first pose of ``path`` through the others."""
    if wielded is not None:
        return Moved(_carried(world, wielded, path), len(path) - 1)
    poured = False
    for reached, (start, end) in enumerate(itertools.pairwise(path)):
        for pose in between(start, end):
            if _blocked(world, pose.at):
                return Moved(world, reached)
            world = _wiped(world, pose.at, held)
            if not poured and _tilt(pose, held) >= POURING:
                world, poured = _poured(world, pose.at), True
        world = _pushed(world, start.at, end.at)
        world = _pressed(world, end.at, machine)
    return Moved(world, len(path) - 1)


def between(start: Pose, end: Pose) -> list[Pose]:
    """Close poses on the straight way from one to another, the last one included."""
    far = max(float(np.linalg.norm(end.at - start.at)), 0.1 * start.angle_to(end))
    steps = max(1, math.ceil(far / STEP))
    return [start.towards(end, k / steps) for k in range(1, steps + 1)]


def _tilt(pose: Pose, held: Held) -> float:
    """Radians between what was up when the hand closed and up."""
    up = pose.axes @ held.axes.T @ np.array([0.0, 0.0, 1.0])
    return math.acos(min(1.0, max(-1.0, float(up[2]))))


def _thing_held(world: World) -> Thing | None:
    return world.thing(world.holding) if world.holding else None


def _tables_under(world: World, at: Array) -> list[Thing]:
    found = []
    for table in world.of_type("table"):
        size = table_size(table)
        if size.is_under(at.tolist(), table.at, 0.1) and -TOUCHING <= at[2] - size.height - 0.055 <= TOUCHING:
            found.append(table)
    return found


def _wipes(world: World) -> bool:
    held = _thing_held(world)
    return held is not None and held.kind == "eraser"


def _blocked(world: World, at: Array) -> bool:
    """Whether the eraser meets a thing that stands on the table it is moved over."""
    if not _wipes(world):
        return False
    return any(
        math.dist(at[:2], world.thing(t.name).at[:2]) < IN_THE_WAY + KINDS[t.kind].radius - 0.05
        for table in _tables_under(world, at)
        for t in world.of_type("movable_object")
        if on_table(world, t.name, table.name)
    )


def _wiped(world: World, at: Array, held: Held) -> World:
    """The scribbles of which the eraser at ``at`` has now touched every point are gone."""
    if not _wipes(world):
        return world
    for table in _tables_under(world, at):
        left = []
        for stroke in table.strokes:
            points = np.array(stroke_points(table, stroke)) + np.array(table.at[:2])
            touched = held.touched.setdefault((table.name, stroke), np.zeros(len(points), dtype=np.bool_))
            touched |= np.linalg.norm(points - at[:2], axis=1) < ERASER_REACH
            if not touched.all():
                left.append(stroke)
        world = world.with_thing(replace(table, strokes=tuple(left)))
    return world


def _poured(world: World, at: Array) -> World:
    """What the tilted vessel holds goes into the nearest one below, or is lost."""
    held = _thing_held(world)
    if held is None or held.kind not in VESSELS or not held.contents:
        return world
    emptied = replace(held, contents=(), amount=0.0)
    others = [t for t in world.of_type("container") if t.name != held.name and t.at[2] < at[2]]
    near = [t for t in others if math.dist(t.at[:2], at[:2]) <= POURS_INTO + VESSELS[t.kind].rim / 2]
    if not near:
        return world.with_thing(emptied)
    into = min(near, key=lambda t: math.dist(t.at[:2], at[:2]))
    if into.contents:  # it overflows: what was in it stays
        return world.with_thing(emptied)
    return world.with_thing(emptied, replace(into, contents=held.contents, amount=held.amount))


def _pushed(world: World, start: Array, end: Array) -> World:
    """An empty hand that comes from behind an open lid and ends over the hopper pushes the lid shut."""
    if world.holding is not None:
        return world
    for juicer in world.of_type("juicer"):
        a, b = start - np.array(juicer.at), end - np.array(juicer.at)
        behind = a[0] > HOPPER_RADIUS + 0.03 and abs(a[1]) < HOPPER_RADIUS and a[2] > HOPPER_TOP
        over = math.hypot(b[0], b[1]) < HOPPER_RADIUS and 0 < b[2] - HOPPER_TOP < 0.12
        if juicer.opened and behind and over:
            world = world.with_thing(replace(juicer, opened=False))
    return world


def _pressed(world: World, at: Array, machine: Machine) -> World:
    """A finger that ends at a switch presses it."""
    for juicer in world.of_type("juicer"):
        if world.holding is None and math.dist(at, np.array(juicer.at) + SWITCH) < PRESSES:
            world = machine(world, juicer.name)
    return world


def _carried(world: World, wielded: Wielded, path: Sequence[Pose]) -> World:
    """A bin moves with the hand while physics decides what becomes of its contents.

    As long as it stays level its contents come along; once it tilts, physics runs until it is still again.
    """
    name, stage = wielded.name, stage_for(world)
    contents = inside_of(world, name)
    running = False
    for start, end in itertools.pairwise(path):
        first, last = start * wielded.seen_from_hand, end * wielded.seen_from_hand
        if not running and start.angle_to(end) < 1e-3:
            world = shifted(world, (name, *contents), last.at - np.array(world.thing(name).at))
            continue
        if not running:
            stage.pose(world)
            running = True
        seconds = max(
            float(np.linalg.norm(last.at - first.at)) / CARRYING_SPEED, start.angle_to(end) / TURNING_SPEED, 0.05
        )
        steps = math.ceil(seconds / float(stage.model.opt.timestep))
        for k in range(1, steps + 1):
            now = start.towards(end, k / steps) * wielded.seen_from_hand
            stage.move_fixture(name, vector(now.at), quaternion_of(now.axes))
            stage.advance()
    if running:
        world = stage.moved(world)
        end_pose = path[-1] * wielded.seen_from_hand
        put = replace(world.thing(name), at=vector(end_pose.at), turn=quaternion_of(end_pose.axes))
        world = settled(world.with_thing(put), 1.0)
    return world


def inside_of(world: World, name: str) -> tuple[str, ...]:
    """The things in a bin, wherever it is and however it is turned."""
    bin_ = world.thing(name)
    size, frame = bin_size(bin_), pose_of(bin_).inverse
    found = []
    for thing in world.of_type("movable_object"):
        x, y, z = frame.points(np.array(thing.at))
        within = size.is_under((x, y), (0, 0)) and 0 <= z <= size.height + 0.03
        if within and thing.name != world.holding:
            found.append(thing.name)
    return tuple(found)


def stood_down(world: World, name: str) -> World:
    """A bin that is let go stands on the floor under it, upright, with what lies in it."""
    thing = world.thing(name)
    x, y, z = thing.at
    if math.acos(min(1.0, abs(thing.turn[0]))) < 0.1:
        world = shifted(world, (name, *inside_of(world, name)), (0.0, 0.0, -z))
    return settled(world.with_thing(replace(world.thing(name), at=(x, y, 0.0), turn=UPRIGHT)), 1.0)


def put_down(world: World, vessel: Thing, at: tuple[float, float]) -> World:
    """A vessel that is let go stands on the counter under it, or on the floor."""
    x, y = at
    height = 0.0
    for thing in world.things:
        if thing.kind in ("table", "counter"):
            size = table_size(thing)
            if size.is_under(at, thing.at):
                height = max(height, size.height)
    return replace(world.with_thing(replace(vessel, at=(x, y, height))), holding=None)
