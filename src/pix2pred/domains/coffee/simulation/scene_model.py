"""The coffee scene as a MuJoCo model, built from our own shapes: table, wall, machine, jug, cups, gripper.

One model serves every world: what moves is a mocap body, and a cup's size is chosen among meshes, so that a picture
needs no compilation.
"""

from __future__ import annotations

from typing import Any

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
from pix2pred.domains.physics import Maker

COFFEE = (0.3, 0.14, 0.06)
CREMA = (0.68, 0.42, 0.2)
STEEL = (0.62, 0.64, 0.68)
DARK = (0.13, 0.13, 0.15)
WALL_THICKNESS = 0.004
"""Of jug and cups."""

FULL_HEIGHT = JUG_HEIGHT - 0.016
"""Height of the white mark up to which the machine fills the jug."""

_SIDES = 40
"""Of what is turned: jug, mark and cups."""


def build_model() -> Any:
    """The compiled model. Raises ``MissingExtraError`` without MuJoCo."""
    maker = Maker(1024, 1024)
    maker.ambient(0.42, 0.35)
    maker.spec.visual.headlight.specular = [0.1, 0.1, 0.1]
    maker.spec.visual.map.znear, maker.spec.visual.map.zfar = 0.02, 10.0
    maker.world.add_light(pos=[0.5, 0.5, 1.8], dir=[0.1, 0.4, -0.9], diffuse=[0.5, 0.5, 0.5], castshadow=False)
    _room(maker)
    _machine(maker)
    _jug(maker)
    _cups(maker)
    _gripper(maker)
    return maker.compiled()


def _room(maker: Maker) -> None:
    maker.slab("room/table", (0.5, 0.42, 0.02), (0.74, 1.36, TABLE_Z - 0.02), (0.72, 0.56, 0.4))
    maker.slab("room/wall", (2.5, 0.02, 1.5), (0.74, 1.95, 0.7), (0.8, 0.84, 0.84))
    maker.slab("room/floor", (2.5, 2.0, 0.02), (0.74, 1.0, -0.4), (0.55, 0.55, 0.57))
    for i in range(6):
        maker.slab(f"room/board{i}", (0.5, 0.0012, 0.0006), (0.74, 1.0 + 0.14 * i, TABLE_Z), (0.5, 0.37, 0.25))


def _machine(maker: Maker) -> None:
    x, y = MACHINE_X, MACHINE_Y
    front = y - 0.15
    body = (0.36, 0.4, 0.47)
    name = "coffee_machine"
    maker.slab(f"{name}/base", (0.09, 0.17, 0.011), (x, y, TABLE_Z + 0.011), DARK)
    maker.slab(f"{name}/back", (0.09, 0.07, 0.17), (x, y + 0.1, TABLE_Z + 0.17), body)
    middle, half = (HEAD_BOTTOM + HEAD_TOP) / 2, (HEAD_TOP - HEAD_BOTTOM) / 2
    maker.slab(f"{name}/head", (0.09, 0.16, half), (x, y + 0.01, middle), body)
    maker.slab(f"{name}/top", (0.094, 0.165, 0.008), (x, y + 0.01, HEAD_TOP + 0.006), DARK)
    maker.drum(f"{name}/plate", 0.06, 0.0015, (PLATE.x, PLATE.y, PLATE.z - 0.001), STEEL)
    maker.drum(f"{name}/dispenser", 0.014, 0.012, (PLATE.x, PLATE.y, HEAD_BOTTOM - 0.008), STEEL)
    lamp = (0.3, 0.05, 0.05)
    maker.drum(f"{name}/lamp_rim", 0.026, 0.004, (x + 0.03, front, middle + 0.02), DARK, euler=[90, 0, 0])
    maker.drum(f"{name}/lamp", 0.021, 0.007, (x + 0.03, front - 0.001, middle + 0.02), lamp, euler=[90, 0, 0])
    button = (BUTTON.x + 0.008, BUTTON.y, BUTTON.z)
    maker.drum(f"{name}/button", 0.02, 0.008, button, (0.9, 0.75, 0.1), euler=[0, 90, 0])


def _jug(maker: Maker) -> None:
    r, h, t, z = JUG_RADIUS, JUG_HEIGHT, WALL_THICKNESS, FULL_HEIGHT
    maker.turned("jug", [(0, 0), (r, 0), (r, h), (r - t, h), (r - t, t), (0, t)], _SIDES)
    maker.turned("mark", [(r, z - 0.002), (r + 0.001, z - 0.002), (r + 0.001, z + 0.002), (r, z + 0.002)], _SIDES)
    body = maker.body("jug")
    brand = (0.1, 0.1, 0.12)
    _coffee(maker, "jug", body)
    maker.drum("jug/foot", r + 0.002, 0.003, (0, 0, 0.003), brand, body=body)
    for sign, end in ((1, "high"), (-1, "low")):
        z = 0.075 + 0.034 * sign
        maker.rod(f"jug/handle_{end}", 0.008, (-r + 0.004, 0, z), (-0.088, 0, z), brand, body=body)
    maker.rod("jug/handle", 0.009, (-0.088, 0, 0.041), (-0.088, 0, 0.109), brand, body=body)
    maker.rod("jug/spout", 0.006, (r - 0.01, 0, h - 0.012), (SPOUT.x, 0, SPOUT.z), brand, body=body)
    maker.shape("jug/mark", "mark", (0.95, 0.95, 0.95), body=body)
    maker.shape("jug/glass", "jug", (0.62, 0.8, 0.9), body=body, alpha=0.15)
    maker.drum("jug/stream", 0.003, 0.02, (0, 0, 0), COFFEE, body=maker.body("stream"))


def _cups(maker: Maker) -> None:
    """Slots for cups, which show any of the meshes."""
    for i, capacity in enumerate(CUP_CAPACITIES):
        radius, height, t = CUP_RADIUS[capacity], CUP_HEIGHT[capacity], WALL_THICKNESS
        base = 0.82 * radius
        turned = [(0, 0), (base, 0), (radius, height), (radius - t, height), (base - t, t), (0, t)]
        maker.turned(f"cup{i}", turned, _SIDES)
    for i in range(MOST_CUPS):
        body = maker.body(f"cup{i}")
        _coffee(maker, f"cup{i}", body)
        maker.shape(f"cup{i}/glass", "cup0", (0.85, 0.93, 1.0), body=body, alpha=0.24)


def _coffee(maker: Maker, vessel: str, body: Any) -> None:
    """What is in a vessel; its amount is shown at run time."""
    maker.drum(f"{vessel}/crema", 0.01, 0.001, (0, 0, 0.02), CREMA, body=body)
    maker.drum(f"{vessel}/coffee", 0.01, 0.01, (0, 0, 0.02), COFFEE, body=body)


def _gripper(maker: Maker) -> None:
    body = maker.body("robot")
    white, grey = (0.93, 0.93, 0.95), (0.25, 0.27, 0.32)
    maker.slab("robot/palm", (0.014, 0.042, 0.016), (-0.062, 0, 0), grey, body=body)
    for side, end in ((1, "far"), (-1, "near")):
        maker.slab(f"robot/finger_{end}", (0.032, 0.006, 0.01), (-0.02, 0.02 * side, 0), grey, body=body)
    maker.rod("robot/wrist", 0.02, (-0.07, 0, 0), (-0.1, 0, 0), (0.95, 0.55, 0.1), body=body)
    arm = maker.body("arm")
    maker.rod("robot/elbow", 0.03, (0, 0, 0), (0, 0, 0.02), white, body=arm)
    maker.rod("robot/arm", 0.024, (0, 0, 0.02), (-0.1, 0.12, 0.9), white, body=arm)
