"""A home world as the surroundings of a walking robot: what its cameras take, what its hand takes and changes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.home.cameras import Eye
from pix2pred.domains.home.drawing.fixtures import bin_size, table_size
from pix2pred.domains.home.places import in_bin
from pix2pred.domains.home.roaming import hand as effects
from pix2pred.domains.home.roaming.hand import Held, Wielded
from pix2pred.domains.home.roaming.robot import cameras, make_roaming_robot, pose_robot
from pix2pred.domains.home.settling import let_go, rise_of, settled
from pix2pred.domains.home.stage import PhysicalScene, is_free
from pix2pred.domains.home.world import SCENERY, Machine, Thing, World, no_machine, vector
from pix2pred.domains.physics import mujoco_library
from pix2pred.structs.space.poses import Array, FloorPose, Pose
from pix2pred.structs.space.surroundings import Grip, Seen
from pix2pred.structs.states import Pixels

TRUNK = ((-1.05, -0.23), (0.05, 0.23))
"""Corners of the floor that the robot covers, from the place under its nose: legs, and what it needs to stand."""

ROOM = 2.75
"""Metres from the middle of the room to where the robot's trunk can be at most."""

_THIN = ("shade", "shadow")
"""Drawings of shadows are nothing that a ray meets."""


class RoamingHome:
    """A world with a robot in it, for one thread. ``machine`` is what a pressed switch of a juicer does."""

    def __init__(self, world: World, machine: Machine = no_machine) -> None:
        self.cameras = cameras()
        self.names: tuple[str, ...] = tuple(sorted(t.name for t in world.things if t.type != SCENERY))
        self.start = FloorPose()
        self.world = world
        self._machine = machine
        self._stage = PhysicalScene(world, make_roaming_robot)
        self._eye: Eye | None = None
        self._place, self._hand = self.start, Pose()
        self._wielded: Wielded | None = None
        self._held = Held()
        self._posed = False

    @property
    def holding(self) -> str | None:
        return self._wielded.name if self._wielded else self.world.holding

    def stands(self, place: FloorPose) -> bool:
        (left, right), (front, side) = TRUNK
        corners = [place.point(x, y) for x in (left, front) for y in (right, side)]
        if any(max(abs(x), abs(y)) > ROOM for x, y in corners):
            return False
        return not any(_overlap(place, thing) for thing in self.world.things if not is_free(thing))

    def put_robot(self, place: FloorPose, hand: Pose) -> None:
        self._place, self._hand, self._posed = place, hand, False

    def colour(self, camera: str) -> Pixels:
        return self._looking().pixels(camera)

    def depth(self, camera: str) -> NDArray[np.float32]:
        return self._looking().depth(camera)

    def owners(self, camera: str) -> NDArray[np.int32]:
        eye = self._looking()
        numbers = eye.numbers(camera)
        owner = np.zeros(self._stage.model.ngeom + 1, dtype=np.int32)  # the last entry is nobody's
        for name, geoms in self._stage.objects(self.world).items():
            if name in self.names:
                owner[list(geoms)] = self.names.index(name) + 1
        return owner[numbers]

    def seen(self, origin: Array, direction: Array) -> Seen | None:
        self._pose()
        mujoco, model = mujoco_library(), self._stage.model
        at, along = np.array(origin, dtype=float), direction / np.linalg.norm(direction)
        owner = {g: n for n, geoms in self._stage.objects(self.world).items() for g in geoms}
        while True:
            geom = np.full((1, 1), -1, dtype=np.int32)
            far = mujoco.mj_ray(model, self._stage.data, at.reshape(3, 1), along.reshape(3, 1), None, True, -1, geom)
            if far < 0:
                return None
            at = at + far * along
            met = model.geom(int(geom[0, 0])).name
            kind, _, part = met.partition("/")
            if kind.partition("-")[0] not in (*_THIN, "body") and part != "glass" and "-guard" not in part:
                return Seen(at, owner.get(int(geom[0, 0])))
            at = at + 1e-4 * along

    def grasp(self, name: str) -> Grip:
        thing = self.world.thing(name)
        if thing.type == "trash_can":
            self._wielded = Wielded(name, self._hand.inverse * effects.pose_of(thing))
            return Grip.TAKEN
        if thing.type not in ("movable_object", "container"):
            return Grip.NOTHING
        for bin_ in self.world.of_type("trash_can"):
            if in_bin(self.world, name, bin_.name) and (bin_.kind == "narrow_bin" or not bin_.opened):
                return Grip.STUCK
        self._held.axes = self._hand.axes
        after = replace(self.world, holding=name)
        self._change(settled(after, effects.SETTLING) if is_free(thing) else after)
        return Grip.TAKEN

    def let_go(self) -> None:
        if self._wielded is not None:
            self._change(effects.stood_down(self.world, self._wielded.name))
            self._wielded = None
        elif self.world.holding is not None:
            thing = self.world.thing(self.world.holding)
            x, y, z = vector(self._hand.at)
            if is_free(thing):
                self._change(let_go(self.world, thing.name, (x, y, z - rise_of(thing))))
            else:
                self._change(effects.put_down(self.world, thing, (x, y)))

    def move_hand(self, path: Sequence[Pose]) -> int:
        done = effects.moved(self.world, self._wielded, [self._hand, *path], self._held, self._machine)
        self._change(done.world)
        if done.reached:
            self._hand = path[done.reached - 1]
        return done.reached

    def truth(self) -> dict[str, Any]:
        return self.world.to_dict() | {"robot": [self._place.x, self._place.y, self._place.yaw]}

    def close(self) -> None:
        if self._eye is not None:
            self._eye.close()
            self._eye = None

    def _change(self, world: World) -> None:
        self.world, self._posed = world, False

    def _pose(self) -> None:
        if not self._posed:
            pose_robot(self._stage, self._place, self._hand)
            self._stage.pose(self.world)
            self._posed = True

    def _looking(self) -> Eye:
        self._pose()
        if self._eye is None:
            self._eye = Eye(self._stage)
        return self._eye


def _overlap(place: FloorPose, thing: Thing) -> bool:
    """Whether the robot's trunk and a fixture that stands on the floor share floor (separating axes)."""
    half = _half_sizes(thing)
    if half is None:
        return False
    (left, right), (front, side) = TRUNK
    trunk = np.array([place.point(x, y) for x in (left, front) for y in (right, side)])
    x, y = thing.at[:2]
    box = np.array([(x + a * half[0], y + b * half[1]) for a in (-1, 1) for b in (-1, 1)])
    ahead = np.array([math.cos(place.yaw), math.sin(place.yaw)])
    for axis in (np.array([1.0, 0.0]), np.array([0.0, 1.0]), ahead, np.array([-ahead[1], ahead[0]])):
        a, b = trunk @ axis, box @ axis
        if a.max() <= b.min() or b.max() <= a.min():
            return False
    return True


def _half_sizes(thing: Thing) -> tuple[float, float] | None:
    sizes: Mapping[str, Any] = {
        "table": table_size,
        "counter": table_size,
        "narrow_bin": bin_size,
        "wide_bin": bin_size,
    }
    if thing.kind not in sizes:
        return None
    size = sizes[thing.kind](thing)
    return size.half_x, size.half_y
