"""The picture of a world, and the boxes of what is seen of its objects."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pix2pred.domains.coffee.scenes import MOST_CUPS
from pix2pred.domains.coffee.simulation.geometry import (
    CUP_CAPACITIES,
    CUP_HEIGHT,
    CUP_RADIUS,
    FULL_JUG,
    GRIP,
    JUG_RADIUS,
    TABLE_Z,
    Point,
    turned,
)
from pix2pred.domains.coffee.simulation.motion import pouring_over
from pix2pred.domains.coffee.simulation.scene_model import FULL_HEIGHT, WALL_THICKNESS, build_model
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.domains.physics import Camera, mujoco_library
from pix2pred.structs import Picture, Pixels

CAMERA = "front"

_AWAY = (0.0, -5.0, -5.0)
_ON, _OFF = (0.25, 1.0, 0.3, 1.0), (0.3, 0.06, 0.06, 1.0)


class PosedModel:
    """The model, posed as a world. Use it in one thread only."""

    def __init__(self) -> None:
        mujoco = mujoco_library()
        self._mujoco = mujoco
        self.model = build_model()
        self.data = mujoco.MjData(self.model)
        view = mujoco.MjvCamera()
        view.lookat[:] = (0.725, 1.38, 0.345)
        view.distance, view.azimuth, view.elevation = 1.25, 90.0, -32.0
        self.model.vis.global_.fovy = 35.0
        self.camera = Camera(self.model, view, CAMERA)
        names = [self.model.geom(i).name for i in range(self.model.ngeom)]
        self._geoms = {name: i for i, name in enumerate(names)}
        self._cup_meshes = [self.model.mesh(f"cup{i}").id for i in range(len(CUP_CAPACITIES))]

    def pose(self, world: CoffeeWorld) -> None:
        """Put everything where ``world`` says."""
        self._look(world.look)
        robot, at = world.robot, world.robot.at
        half = robot.tilt / 2
        swing = (math.cos(half), 0.0, math.sin(half), 0.0)
        spin = (math.cos(robot.wrist / 2), math.sin(robot.wrist / 2), 0.0, 0.0)
        hand = np.empty(4)
        self._mujoco.mju_mulQuat(hand, swing, spin)
        self._move("robot", at, hand)
        for side, end in ((1, "far"), (-1, "near")):
            self.model.geom_pos[self._geoms[f"robot/finger_{end}"]][1] = side * (robot.fingers / 2 + 0.006)
        self._move("arm", at + turned(Point(-0.105, 0, 0), robot.tilt))
        jug = world.jug
        if jug.held:
            self._move("jug", at - turned(GRIP, robot.tilt), swing)
        else:
            self._move("jug", jug.at, (math.cos(jug.rot / 2), 0.0, 0.0, math.sin(jug.rot / 2)))
        height = (FULL_HEIGHT - 0.006) * jug.level / FULL_JUG
        self._liquid("jug", JUG_RADIUS - WALL_THICKNESS - 0.001, 0.006, height)
        self._stream(world)
        self.model.geom_rgba[self._geoms["coffee_machine/lamp"]] = _ON if world.machine_on else _OFF
        self._cups(world)
        self._mujoco.mj_forward(self.model, self.data)

    def objects(self, world: CoffeeWorld) -> Mapping[str, Sequence[int]]:
        """The geoms of every object of ``world``."""
        slots = {cup.name: f"cup{i}" for i, cup in enumerate(world.cups)}
        parts = {name: slots.get(name, name) for name in world.types()}
        return {
            name: [i for g, i in self._geoms.items() if g.startswith(part + "/") and g != "jug/stream"]
            for name, part in parts.items()
        }

    def _cups(self, world: CoffeeWorld) -> None:
        for i in range(MOST_CUPS):
            if i >= len(world.cups):
                self._move(f"cup{i}", Point(*_AWAY))
                continue
            cup = world.cups[i]
            self._move(f"cup{i}", Point(cup.x, cup.y, TABLE_Z))
            size = CUP_CAPACITIES.index(cup.capacity)
            glass = self._geoms[f"cup{i}/glass"]
            mesh = self._cup_meshes[size]
            self.model.geom_dataid[glass] = mesh
            # a mesh geom sits at its mesh's own centre
            self.model.geom_pos[glass] = self.model.mesh_pos[mesh]
            self.model.geom_quat[glass] = self.model.mesh_quat[mesh]
            share = cup.current / cup.capacity
            radius = CUP_RADIUS[cup.capacity] * (0.82 + 0.18 * share) - WALL_THICKNESS - 0.001
            self._liquid(f"cup{i}", radius, WALL_THICKNESS, (CUP_HEIGHT[cup.capacity] - 2 * WALL_THICKNESS) * share)

    def _liquid(self, part: str, radius: float, bottom: float, height: float) -> None:
        """A column of coffee with a lighter surface; nothing when there is none."""
        coffee, crema = self._geoms[f"{part}/coffee"], self._geoms[f"{part}/crema"]
        shown = height > 1e-4
        for geom in (coffee, crema):
            self.model.geom_rgba[geom][3] = 1.0 if shown else 0.0
        self.model.geom_size[coffee][:2] = (radius, max(height, 1e-4) / 2)
        self.model.geom_pos[coffee] = (0, 0, bottom + height / 2)
        self.model.geom_size[crema][:2] = (radius, 0.001)
        self.model.geom_pos[crema] = (0, 0, bottom + height + 0.0005)

    def _stream(self, world: CoffeeWorld) -> None:
        """The thread of coffee between a leaning jug and the cup under it."""
        cup = pouring_over(world)
        if cup is None or world.jug.level <= 0:
            self._move("stream", Point(*_AWAY))
            return
        top, bottom = world.spout.z, TABLE_Z + CUP_HEIGHT[cup.capacity] * cup.current / cup.capacity
        self.model.geom_size[self._geoms["jug/stream"]][:2] = (0.003, (top - bottom) / 2)
        self._move("stream", Point(world.spout.x, world.spout.y, (top + bottom) / 2))

    def _look(self, look: int) -> None:
        """The seeded colours of table, wall and machine."""
        rng = np.random.default_rng(np.random.SeedSequence((look, 77)))
        table = np.array([(0.72, 0.56, 0.40), (0.62, 0.45, 0.30), (0.80, 0.70, 0.55), (0.60, 0.58, 0.55)])
        wall = np.array([(0.80, 0.84, 0.84), (0.86, 0.82, 0.74), (0.70, 0.77, 0.72), (0.74, 0.76, 0.84)])
        machine = np.array([(0.36, 0.40, 0.47), (0.52, 0.20, 0.18), (0.22, 0.36, 0.34), (0.55, 0.55, 0.58)])
        self._paint("room/table", table, rng)
        self._paint("room/wall", wall, rng)
        self._paint("coffee_machine/head", machine, rng)
        self.model.geom_rgba[self._geoms["coffee_machine/back"]] = self.model.geom_rgba[
            self._geoms["coffee_machine/head"]
        ] * (0.9, 0.9, 0.9, 1)

    def _paint(self, geom: str, palette: Any, rng: np.random.Generator) -> None:
        colour = palette[int(rng.integers(len(palette)))] + rng.uniform(-0.03, 0.03, 3)
        self.model.geom_rgba[self._geoms[geom]] = (*np.clip(colour, 0, 1), 1)

    def _move(self, body: str, at: Point, quat: ArrayLike = (1, 0, 0, 0)) -> None:
        mocap = int(self.model.body(body).mocapid[0])
        self.data.mocap_pos[mocap] = tuple(at)
        self.data.mocap_quat[mocap] = quat


@cache
def _stage() -> PosedModel:
    return PosedModel()


def render(world: CoffeeWorld) -> Picture:
    """The picture of ``world``, 480x480, with the boxes of all objects that are seen."""
    stage = _stage()
    stage.pose(world)
    return stage.camera.picture(stage.data, stage.objects(world))


def render_pixels(world: CoffeeWorld) -> Pixels:
    """The pixels of the picture alone."""
    stage = _stage()
    stage.pose(world)
    return stage.camera.pixels(stage.data)
