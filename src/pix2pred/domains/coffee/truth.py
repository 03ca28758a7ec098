"""Ground truth of visual words, for tests, for training the reader, and for naming failures once they happened."""

from __future__ import annotations

import math
from collections.abc import Mapping

from pix2pred.domains.coffee.simulation.geometry import FULL_JUG
from pix2pred.domains.coffee.simulation.motion import cup_below, pouring_over, pressing
from pix2pred.domains.coffee.skills import handle_reachable
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.domains.words import Concept, TrueWords


def _receiving(world: CoffeeWorld, cup: str) -> bool:
    below = pouring_over(world)
    return below is not None and below.name == cup


def _jug_above(world: CoffeeWorld, jug: str, cup: str) -> bool:
    below = cup_below(world) if world.jug.held else None
    return below is not None and below.name == cup


CONCEPTS: Mapping[str, Concept] = {
    "cup_filled": Concept(("cup",), lambda w, cup: w.cup(cup).filled),
    "cup_receiving": Concept(("cup",), _receiving),
    "jug_filled": Concept(("jug",), lambda w, jug: w.jug.level >= FULL_JUG - 1e-6),
    "jug_has_coffee": Concept(("jug",), lambda w, jug: w.jug.level > 0),
    "jug_in_machine": Concept(("jug", "coffee_machine"), lambda w, jug, machine: w.jug_in_machine),
    "jug_on_table": Concept(("jug",), lambda w, jug: not w.jug.held and not w.jug_in_machine),
    "jug_held": Concept(("jug",), lambda w, jug: w.jug.held),
    "jug_tilted": Concept(("jug",), lambda w, jug: abs(w.jug_tilt) > math.radians(20)),
    "jug_above": Concept(("jug", "cup"), _jug_above),
    "handle_reachable": Concept(("jug",), lambda w, jug: handle_reachable(w)),
    "machine_on": Concept(("coffee_machine",), lambda w, machine: w.machine_on),
    "machine_occupied": Concept(("coffee_machine",), lambda w, machine: w.jug_in_machine),
    "hand_empty": Concept(("robot",), lambda w, robot: not w.jug.held),
    "holding": Concept(("robot", "jug"), lambda w, robot, jug: w.jug.held),
    "pressing": Concept(("robot", "coffee_machine"), lambda w, robot, machine: pressing(w)),
    "larger": Concept(("cup", "cup"), lambda w, a, b: w.cup(a).capacity > w.cup(b).capacity),
}
"""Every word with a ground truth. ``jug_filled``: to the mark, so that it ends with the first cup poured."""

concept_value = TrueWords(CONCEPTS, CoffeeWorld.types).value
