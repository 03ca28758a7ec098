"""Pictures of the kitchen."""

from __future__ import annotations

from typing import Any

from pix2pred.domains.kitchen.model import geoms_of_objects, kitchen_camera, kitchen_model
from pix2pred.domains.kitchen.world import KitchenWorld
from pix2pred.domains.physics import mujoco_library
from pix2pred.structs import Picture


def picture_of(data: Any) -> Picture:
    """A simulation seen from the front, with the boxes of what is visible."""
    return kitchen_camera().picture(data, geoms_of_objects())


def simulation_of(world: KitchenWorld) -> Any:
    """A simulation showing ``world``."""
    mujoco = mujoco_library()
    data = mujoco.MjData(kitchen_model())
    data.qpos[:] = world.positions
    mujoco.mj_forward(kitchen_model(), data)
    return data


def render(world: KitchenWorld) -> Picture:
    """The picture of ``world``."""
    return picture_of(simulation_of(world))
