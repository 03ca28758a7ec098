"""The Franka kitchen of the ``gymnasium-robotics`` wheel, loaded with ``mujoco.MjSpec`` (not through its Gym class)."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from pix2pred.domains.kitchen.vocabulary import OBJECT_OF
from pix2pred.domains.physics import Camera, mujoco_library
from pix2pred.domains.physics.camera import SIZE
from pix2pred.system.extras import MissingExtraError, install_command

_SCENE = "envs/assets/kitchen_franka/kitchen_assets/kitchen_env_model.xml"

_GLOW = 0.0009
"""Metres the red plate under a burner is raised, so that it shows from the knob angle on that counts as on."""

_BODIES: Mapping[str, tuple[str, ...]] = {
    "gripper": ("panda0_link7", "panda0_leftfinger", "panda0_rightfinger"),
    "kettle": ("kettleroot",),
    **{f"knob{i}": (f"knob {i}",) for i in range(1, 5)},
    "light": ("lightswitchbaseroot", "lightswitchroot"),
}
"""The bodies that make up an object, for those made of whole bodies."""

_HANDLES: Mapping[str, tuple[str, str]] = {
    "slide": ("slidelink", "slide_site"),
    "hinge1": ("hingeleftdoor", "hinge_site1"),
    "hinge2": ("hingerightdoor", "hinge_site2"),
    "microhandle": ("microdoorroot", "microhandle_site"),
}
"""Doors are known by their handles: the body and the site on its handle."""

_LEAST_PIXELS: Mapping[str, int] = {name: 800 if name.startswith("burner") else 300 for name in OBJECT_OF}
"""An object of which fewer pixels are seen is hidden: about a third of what a burner, half of what a knob shows."""

_HANDLE_REACH, _HANDLE_SIZE = 0.2, 0.25
"""Geoms of a door that are near the handle's site and not larger (metres) belong to the handle."""


def scene_file() -> Path:
    """The model's file; the package is found but not imported, because importing it registers and warns.

    Raises ``MissingExtraError`` when it is not installed.
    """
    found = importlib.util.find_spec("gymnasium_robotics")
    if found is None or found.origin is None:
        raise MissingExtraError(
            "the kitchen's model is in gymnasium-robotics, which is not installed; "
            f"install it with: {install_command('sim')}"
        )
    return Path(found.origin).parent / _SCENE


@cache
def kitchen_model() -> Any:
    """The compiled model, one per process: the arm carries its own weight, pictures are small and without shadows.

    Raises ``MissingExtraError`` when the extra ``sim`` is not installed.
    """
    mujoco = mujoco_library()
    spec = mujoco.MjSpec.from_file(str(scene_file()))
    for body in spec.bodies:
        if body.name.startswith("panda0_"):
            body.gravcomp = 1
        if body.name.startswith("Burner"):
            for plate in body.geoms:
                plate.pos = (0, 0, _GLOW)
    for light in spec.lights:
        if light.name == "ovenlight":
            light.active = False  # it whitens one burner and hides its glow
    spec.visual.headlight.diffuse = (0.5, 0.5, 0.5)
    spec.visual.global_.offwidth = spec.visual.global_.offheight = SIZE
    spec.visual.quality.offsamples = 0
    model = spec.compile()
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)  # divergence is reported, not papered over
    return model


@cache
def kitchen_camera() -> Camera:
    """The camera all pictures are taken with, high up in front of the stove."""
    mujoco = mujoco_library()
    view = mujoco.MjvCamera()
    view.lookat[:] = (-0.09, 0.52, 1.92)
    view.distance, view.azimuth, view.elevation = 2.05, 88, -56
    return Camera(kitchen_model(), view, least_pixels=_LEAST_PIXELS)


@cache
def geoms_of_objects() -> Mapping[str, frozenset[int]]:
    """The geoms that show each object. A burner is its red plate with the coil and the rim around it."""
    mujoco, model = mujoco_library(), kitchen_model()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    body_of = [model.body(int(b)).name for b in model.geom_bodyid]
    found = {name: frozenset(g for g, body in enumerate(body_of) if body in bodies) for name, bodies in _BODIES.items()}
    small = model.geom_rbound < _HANDLE_SIZE
    for name, (body, site) in _HANDLES.items():
        near = abs(data.geom_xpos - data.site(site).xpos).max(axis=1) < _HANDLE_REACH
        found[name] = frozenset(g for g, b in enumerate(body_of) if b == body and near[g] and small[g])
    for i in range(1, 5):
        centre = data.body(f"Burner {i}").xpos[:2]
        around = abs(data.geom_xpos[:, :2] - centre).max(axis=1) < 0.02
        coil = {g for g, b in enumerate(body_of) if b == "ovenroot" and around[g] and model.geom_dataid[g] >= 0}
        found[f"burner{i}"] = frozenset(coil | {g for g, b in enumerate(body_of) if b == f"Burner {i}"})
    return found
