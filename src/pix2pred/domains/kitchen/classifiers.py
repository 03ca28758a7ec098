"""The exact truth of the given predicates, and the object features (method 10.1)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from pix2pred.domains.given import holding
from pix2pred.domains.kitchen.vocabulary import KETTLE_BOILING, LINKED, OBJECTS
from pix2pred.domains.physics import mujoco_library
from pix2pred.structs import Atom
from pix2pred.structs.samplers import Features

ON_ANGLE = -0.22
"""A knob turned further than this (radians) is on."""

NEAR_CENTRE = 0.18
"""Metres in x and y within which the kettle is on a burner."""

UPRIGHT = 0.9
"""Cosine of the kettle's tilt above which it stands."""

_ANGLES: Mapping[str, str] = {
    **{f"knob{i}": f"knob_Joint_{i}" for i in range(1, 5)},
    "light": "light_switch",
    "slide": "slide_cabinet",
    "hinge1": "left_hinge_cabinet",
    "hinge2": "right_hinge_cabinet",
    "microhandle": "microwave",
}
_SITES: Mapping[str, str] = {
    **{f"knob{i}": f"knob{i}_site" for i in range(1, 5)},
    "light": "light_site",
    "slide": "slide_site",
    "hinge1": "hinge_site1",
    "hinge2": "hinge_site2",
    "microhandle": "microhandle_site",
}


def features_of(data: Any) -> Features:
    """Positions in metres, joint angles in radians (metres for the sliding door), the gripper's orientation."""
    features = {}
    for item in OBJECTS:
        if item.name == "gripper":
            quaternion = np.zeros(4)
            mujoco_library().mju_mat2Quat(quaternion, data.site("end_effector").xmat)
            values = [*data.site("end_effector").xpos, *quaternion]
        elif item.name == "kettle":
            values = list(data.body("kettle").xpos)
        elif item.name.startswith("burner"):
            values = list(data.body(f"Burner {item.name[-1]}").xpos)
        else:
            values = [*data.site(_SITES[item.name]).xpos, data.joint(_ANGLES[item.name]).qpos[0]]
        features[item] = tuple(float(v) for v in values)
    return features


def knob_angle(data: Any, knob: str) -> float:
    """Radians; 0 is off, negative is turned."""
    return float(data.joint(_ANGLES[knob]).qpos[0])


def is_on(data: Any, knob: str) -> bool:
    """Whether a knob is turned on."""
    return knob_angle(data, knob) < ON_ANGLE


def is_upright(data: Any) -> bool:
    """Whether the kettle stands."""
    return bool(data.body("kettle").xmat[8] > UPRIGHT)


def is_kettle_on(data: Any, burner: str, tolerance: float = NEAR_CENTRE) -> bool:
    """Whether the kettle stands on a burner, its middle within ``tolerance`` metres in x and y."""
    kettle, centre = data.body("kettle").xpos, data.body(f"Burner {burner[-1]}").xpos
    return bool(
        abs(kettle[0] - centre[0]) <= tolerance
        and abs(kettle[1] - centre[1]) <= tolerance
        and kettle[2] > centre[2]
        and is_upright(data)
    )


def are_linked(knob: str, burner: str) -> bool:
    """Whether a knob turns on a burner: they carry the same number."""
    return knob[-1] == burner[-1]


def holds(data: Any, atom: Atom) -> bool:
    """Whether a given atom is true. Raises ``ValueError`` for a predicate of another domain."""
    names = [o.name for o in atom.objects]
    if atom.predicate == LINKED:
        return are_linked(*names)
    if atom.predicate == KETTLE_BOILING:
        _, burner, knob = names
        return are_linked(knob, burner) and is_on(data, knob) and is_kettle_on(data, burner)
    raise ValueError(f"{atom.predicate.name} is not a given predicate of the kitchen")


def true_atoms(data: Any) -> frozenset[Atom]:
    """The given atoms that hold."""
    return holding((KETTLE_BOILING, LINKED), OBJECTS, partial(holds, data))
