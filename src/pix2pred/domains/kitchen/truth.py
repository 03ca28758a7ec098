"""Ground truth of visual words, for tests, for training the reader, and for naming failures once they happened."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pix2pred.domains.kitchen.classifiers import is_kettle_on, is_on
from pix2pred.domains.kitchen.environment import KitchenEnvironment
from pix2pred.domains.kitchen.render import simulation_of
from pix2pred.domains.kitchen.vocabulary import OBJECTS
from pix2pred.domains.kitchen.world import KitchenWorld
from pix2pred.domains.words import Concept, TrueWords

ASIDE = 0.3
"""x of the gripper (metres) beyond which it is aside."""

CONCEPTS: Mapping[str, Concept] = {
    "burner_on": Concept(("surface",), lambda data, burner: is_on(data, f"knob{burner[-1]}")),
    "has_kettle": Concept(("surface",), is_kettle_on),
    "knob_turned": Concept(("knob",), is_on),
    "kettle_on": Concept(("kettle", "surface"), lambda data, kettle, burner: is_kettle_on(data, burner)),
    "gripper_aside": Concept(("gripper",), lambda data, gripper: bool(data.site("end_effector").xpos[0] > ASIDE)),
}
"""Every word with a ground truth."""

_WORDS = TrueWords(CONCEPTS, lambda data: {o.name: o.type.name for o in OBJECTS})

_last: list[tuple[KitchenWorld, Any]] = []


def concept_value(world: KitchenWorld, concept: str, names: Sequence[str]) -> bool:
    """The value of ``concept`` for the objects called ``names``. Raises ``ValueError`` when either does not fit."""
    if not _last or _last[0][0] is not world:
        _last[:] = [(world, simulation_of(world))]
    return _WORDS.value(_last[0][1], concept, names)


def value_now(environment: KitchenEnvironment, concept: str, names: Sequence[str]) -> bool:
    """The value of ``concept`` in the environment's present state."""
    return _WORDS.value(environment.data, concept, names)
