"""What leaves the simulator: a picture, features and given atoms, never hidden state (method 1.2)."""

from __future__ import annotations

from typing import Any

from pix2pred.domains.kitchen.classifiers import features_of, true_atoms
from pix2pred.domains.kitchen.render import picture_of
from pix2pred.structs import State


def observe(data: Any) -> State:
    """The state seen in a simulation."""
    return State((picture_of(data),), features_of(data), true_atoms(data))
