"""The coffee scene as a MuJoCo model, built from our own shapes: table, wall, machine, jug, cups, gripper.

One model serves every world: what moves is a mocap body, and a cup's size is chosen among meshes, so that a picture
needs no compilation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from pix2pred.domains.coffee.scenes import MOST_CUPS
from pix2pred.domains.coffee.simulation.geometry import (
    BUTTON,
    CUP_CAPACITIES,
    CUP_HEIGHT,
    CUP_RADIUS,
    HEAD_BOTTOM,
    HEAD_TOP,
    JUG_HEIGHT,
    JUG_RADIUS,
    MACHINE_X,
    MACHINE_Y,
    PLATE,
    SPOUT,
    TABLE_Z,
)
from pix2pred.domains.physics import mujoco_library

COFFEE = (0.3, 0.14, 0.06, 1.0)
CREMA = (0.68, 0.42, 0.2, 1.0)
GLASS, CUP_GLASS = (0.62, 0.8, 0.9, 0.15), (0.85, 0.93, 1.0, 0.24)
STEEL = (0.62, 0.64, 0.68, 1.0)
DARK = (0.13, 0.13, 0.15, 1.0)
WALL_THICKNESS = 0.004
"""Of jug and cups."""

FULL_HEIGHT = JUG_HEIGHT - 0.016
"""Height of the white mark up to which the machine fills the jug."""

_SIDES = 40

Profile = Sequence[tuple[float, float]]
"""Radius and height of a turned shape, from the middle of its outside bottom to the middle of its inside bottom."""


def build_model() -> Any:
    """The compiled model. Raises ``MissingExtraError`` without MuJoCo."""
    mujoco = mujoco_library()
    spec = mujoco.MjSpec()
    spec.visual.global_.offwidth = spec.visual.global_.offheight = 1024
    spec.visual.quality.offsamples = 4
    spec.visual.headlight.ambient = [0.42, 0.42, 0.42]
    spec.visual.headlight.diffuse = [0.35, 0.35, 0.35]
    spec.visual.headlight.specular = [0.1, 0.1, 0.1]
    spec.visual.map.znear, spec.visual.map.zfar = 0.02, 10.0
    spec.worldbody.add_light(pos=[0.5, 0.5, 1.8], dir=[0.1, 0.4, -0.9], diffuse=[0.5, 0.5, 0.5], castshadow=False)
    _meshes(spec)
    builder = _Builder(mujoco, spec)
    builder.room()
    builder.machine()
    builder.jug()
    for i in range(MOST_CUPS):
        builder.cup(i)
    builder.gripper()
    return spec.compile()


def _meshes(spec: Any) -> None:
    for i, capacity in enumerate(CUP_CAPACITIES):
        radius, height, t = CUP_RADIUS[capacity], CUP_HEIGHT[capacity], WALL_THICKNESS
        base = 0.82 * radius
        turned = [(0, 0), (base, 0), (radius, height), (radius - t, height), (base - t, t), (0, t)]
        vertices, faces = _lathe(turned)
        spec.add_mesh(name=f"cup{i}", uservert=vertices, userface=faces, inertia=_shell())
    r, h, t = JUG_RADIUS, JUG_HEIGHT, WALL_THICKNESS
    turned = [(0, 0), (r, 0), (r, h), (r - t, h), (r - t, t), (0, t)]
    vertices, faces = _lathe(turned)
    spec.add_mesh(name="jug", uservert=vertices, userface=faces, inertia=_shell())
    z = FULL_HEIGHT
    turned = [(r, z - 0.002), (r + 0.001, z - 0.002), (r + 0.001, z + 0.002), (r, z + 0.002)]
    vertices, faces = _lathe(turned)
    spec.add_mesh(name="mark", uservert=vertices, userface=faces, inertia=_shell())


def _shell() -> Any:
    return mujoco_library().mjtMeshInertia.mjMESH_INERTIA_SHELL


def _lathe(profile: Profile) -> tuple[list[float], list[int]]:
    """A profile turned about the vertical axis, as vertices and triangles facing outward."""
    angles = np.linspace(0, 2 * math.pi, _SIDES, endpoint=False)
    vertices = [(r * math.cos(a), r * math.sin(a), z) for r, z in profile for a in angles]
    faces = []
    for ring in range(len(profile) - 1):
        for k in range(_SIDES):
            a, b = ring * _SIDES + k, ring * _SIDES + (k + 1) % _SIDES
            c, d = a + _SIDES, b + _SIDES
            if profile[ring][0] > 0:
                faces.append((a, b, d))
            if profile[ring + 1][0] > 0:
                faces.append((a, d, c))
    return [float(v) for point in vertices for v in point], [int(i) for face in faces for i in face]


class _Builder:
    """Adds bodies and geoms. Geoms are named ``object/part``; nothing collides."""

    def __init__(self, mujoco: Any, spec: Any) -> None:
        kinds = mujoco.mjtGeom
        self.box_type, self.cylinder_type, self.capsule_type = (
            kinds.mjGEOM_BOX,
            kinds.mjGEOM_CYLINDER,
            kinds.mjGEOM_CAPSULE,
        )
        self.mesh_type = kinds.mjGEOM_MESH
        self.spec = spec
        self.world = spec.worldbody

    def add(self, body: Any, name: str, kind: Any, size: Sequence[float], pos: Sequence[float], **more: Any) -> None:
        padded = [*size, *[0.0] * (3 - len(size))]
        body.add_geom(name=name, type=kind, size=padded, pos=list(pos), contype=0, conaffinity=0, **more)

    def box(self, body: Any, name: str, size: Sequence[float], pos: Sequence[float], rgba: Sequence[float]) -> None:
        self.add(body, name, self.box_type, size, pos, rgba=rgba)

    def rod(self, body: Any, name: str, radius: float, a: Sequence[float], b: Sequence[float], rgba: Any) -> None:
        body.add_geom(
            name=name, type=self.capsule_type, size=[radius, 0, 0], fromto=[*a, *b], rgba=rgba, contype=0, conaffinity=0
        )

    def disc(self, body: Any, name: str, radius: float, half: float, pos: Sequence[float], rgba: Any) -> None:
        self.add(body, name, self.cylinder_type, (radius, half), pos, rgba=rgba)

    def room(self) -> None:
        self.box(self.world, "room/table", (0.5, 0.42, 0.02), (0.74, 1.36, TABLE_Z - 0.02), (0.72, 0.56, 0.4, 1))
        self.box(self.world, "room/wall", (2.5, 0.02, 1.5), (0.74, 1.95, 0.7), (0.8, 0.84, 0.84, 1))
        self.box(self.world, "room/floor", (2.5, 2.0, 0.02), (0.74, 1.0, -0.4), (0.55, 0.55, 0.57, 1))
        for i in range(6):
            self.box(
                self.world,
                f"room/board{i}",
                (0.5, 0.0012, 0.0006),
                (0.74, 1.0 + 0.14 * i, TABLE_Z),
                (0.5, 0.37, 0.25, 1),
            )

    def machine(self) -> None:
        x, y = MACHINE_X, MACHINE_Y
        front = y - 0.15
        body = (0.36, 0.4, 0.47, 1)
        name = "coffee_machine"
        self.box(self.world, f"{name}/base", (0.09, 0.17, 0.011), (x, y - 0.0, TABLE_Z + 0.011), DARK)
        self.box(self.world, f"{name}/back", (0.09, 0.07, 0.17), (x, y + 0.1, TABLE_Z + 0.17), body)
        middle, half = (HEAD_BOTTOM + HEAD_TOP) / 2, (HEAD_TOP - HEAD_BOTTOM) / 2
        self.box(self.world, f"{name}/head", (0.09, 0.16, half), (x, y + 0.01, middle), body)
        self.box(self.world, f"{name}/top", (0.094, 0.165, 0.008), (x, y + 0.01, HEAD_TOP + 0.006), DARK)
        self.disc(self.world, f"{name}/plate", 0.06, 0.0015, (PLATE.x, PLATE.y, PLATE.z - 0.001), STEEL)
        self.disc(self.world, f"{name}/dispenser", 0.014, 0.012, (PLATE.x, PLATE.y, HEAD_BOTTOM - 0.008), STEEL)
        self.add(
            self.world,
            f"{name}/lamp_rim",
            self.cylinder_type,
            (0.026, 0.004),
            (x + 0.03, front + 0.0, middle + 0.02),
            rgba=DARK,
            euler=[90, 0, 0],
        )
        self.add(
            self.world,
            f"{name}/lamp",
            self.cylinder_type,
            (0.021, 0.007),
            (x + 0.03, front - 0.001, middle + 0.02),
            rgba=(0.3, 0.05, 0.05, 1),
            euler=[90, 0, 0],
        )
        self.add(
            self.world,
            f"{name}/button",
            self.cylinder_type,
            (0.02, 0.008),
            (BUTTON.x + 0.008, BUTTON.y, BUTTON.z),
            rgba=(0.9, 0.75, 0.1, 1),
            euler=[0, 90, 0],
        )

    def jug(self) -> None:
        body = self.world.add_body(name="jug", mocap=True)
        brand = (0.1, 0.1, 0.12, 1)
        self.disc(body, "jug/crema", 0.01, 0.001, (0, 0, 0.02), CREMA)
        self.disc(body, "jug/coffee", 0.01, 0.01, (0, 0, 0.02), COFFEE)
        self.disc(body, "jug/foot", JUG_RADIUS + 0.002, 0.003, (0, 0, 0.003), brand)
        for sign, end in ((1, "high"), (-1, "low")):
            z = 0.075 + 0.034 * sign
            self.rod(body, f"jug/handle_{end}", 0.008, (-JUG_RADIUS + 0.004, 0, z), (-0.088, 0, z), brand)
        self.rod(body, "jug/handle", 0.009, (-0.088, 0, 0.041), (-0.088, 0, 0.109), brand)
        self.rod(body, "jug/spout", 0.006, (JUG_RADIUS - 0.01, 0, JUG_HEIGHT - 0.012), (SPOUT.x, 0, SPOUT.z), brand)
        self.add(body, "jug/mark", self.mesh_type, (), (0, 0, 0), meshname="mark", rgba=(0.95, 0.95, 0.95, 1))
        self.add(body, "jug/glass", self.mesh_type, (), (0, 0, 0), meshname="jug", rgba=GLASS)
        stream = self.world.add_body(name="stream", mocap=True)
        self.disc(stream, "jug/stream", 0.003, 0.02, (0, 0, 0), COFFEE)

    def cup(self, number: int) -> None:
        body = self.world.add_body(name=f"cup{number}", mocap=True)
        self.disc(body, f"cup{number}/crema", 0.01, 0.001, (0, 0, 0.02), CREMA)
        self.disc(body, f"cup{number}/coffee", 0.01, 0.01, (0, 0, 0.02), COFFEE)
        self.add(body, f"cup{number}/glass", self.mesh_type, (), (0, 0, 0), meshname="cup0", rgba=CUP_GLASS)

    def gripper(self) -> None:
        body = self.world.add_body(name="robot", mocap=True)
        white, grey = (0.93, 0.93, 0.95, 1), (0.25, 0.27, 0.32, 1)
        self.box(body, "robot/palm", (0.014, 0.042, 0.016), (-0.062, 0, 0), grey)
        for side, end in ((1, "far"), (-1, "near")):
            self.box(body, f"robot/finger_{end}", (0.032, 0.006, 0.01), (-0.02, 0.02 * side, 0), grey)
        self.rod(body, "robot/wrist", 0.02, (-0.07, 0, 0), (-0.1, 0, 0), (0.95, 0.55, 0.1, 1))
        arm = self.world.add_body(name="arm", mocap=True)
        self.rod(arm, "robot/elbow", 0.03, (0, 0, 0), (0, 0, 0.02), white)
        self.rod(arm, "robot/arm", 0.024, (0, 0, 0.02), (-0.1, 0.12, 0.9), white)
