"""The state of the kitchen between two skills: joint positions, from which everything else follows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pix2pred.domains.kitchen.arm import JOINTS, REST_AT_HOME
from pix2pred.domains.kitchen.vocabulary import OBJECTS

SIZE = 30
KETTLE = slice(23, 30)
"""Where the kettle's pose (position, quaternion) is among the joint positions."""

KNOBS = (9, 11, 13, 15)
"""Where the angles of knobs 1 to 4 are."""

BURNERS = (10, 12, 14, 16)
"""Where the heights of burners 1 to 4 are; they follow the knobs."""

ANGLE_PER_METRE = 174.0
"""Knob angle per metre the burner's plate moves (the model's own coupling)."""

STANDING = 1.6203
"""Height of the kettle's body when it stands on the stove, in metres."""


@dataclass(frozen=True, slots=True)
class KitchenWorld:
    """Joint positions (metres, radians, a quaternion), as the model orders them; everything is at rest."""

    positions: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.positions) != SIZE or not np.isfinite(self.positions).all():
            raise ValueError(f"a kitchen state is {SIZE} finite numbers")

    def types(self) -> Mapping[str, str]:
        """Type name of every object."""
        return {o.name: o.type.name for o in OBJECTS}

    def to_dict(self) -> dict[str, Any]:
        """JSON-compatible form."""
        return {"positions": list(self.positions)}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> KitchenWorld:
        """Read ``to_dict()``. Raises ``ValueError`` when it is something else."""
        try:
            return cls(tuple(float(v) for v in data["positions"]))
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"not a kitchen state: {error}") from error


def standing_world(x: float, y: float, knobs: tuple[float, float, float, float] = (0, 0, 0, 0)) -> KitchenWorld:
    """The arm at home, the kettle standing at ``(x, y)`` metres, the knobs at angles from 0 (off) to -1.57 radians."""
    positions = np.zeros(SIZE)
    positions[:JOINTS] = REST_AT_HOME
    positions[KETTLE] = (x, y, STANDING, 1, 0, 0, 0)
    for knob, burner, angle in zip(KNOBS, BURNERS, knobs, strict=True):
        positions[knob], positions[burner] = angle, angle / ANGLE_PER_METRE
    return KitchenWorld(tuple(float(v) for v in positions))
