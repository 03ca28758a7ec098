"""Ground truth of visual words, for tests, for training the reader, and for naming failures once they happened."""

from __future__ import annotations

from collections.abc import Mapping

from pix2pred.domains.burger.vocabulary import STATION, TYPE_OF
from pix2pred.domains.burger.world import BurgerWorld, Heading
from pix2pred.domains.words import Concept, TrueWords


def _above(world: BurgerWorld, item: str, support: str) -> bool:
    if world.robot in (item, support) or world.held in (item, support):
        return False
    high, low = world.thing(item), world.thing(support)
    return high.cell == low.cell and high.z > low.z


def _on_station(world: BurgerWorld, item: str) -> bool:
    thing = world.thing(item)
    return item != world.held and any(
        t.cell == thing.cell and TYPE_OF[t.type].is_a(STATION) for t in world.things if t.name != item
    )


def _adjacent(world: BurgerWorld, robot: str, name: str) -> bool:
    return name != world.held and any(world.cell.toward(h) == world.where(name) for h in Heading)


def _stacked(world: BurgerWorld, item: str) -> bool:
    return any(
        t.is_item and (world.supports(item, t.name) or world.supports(t.name, item))
        for t in world.things
        if t.name != item
    )


CONCEPTS: Mapping[str, Concept] = {
    "cooked": Concept(("patty",), lambda w, item: w.thing(item).prepared),
    "chopped": Concept(("lettuce",), lambda w, item: w.thing(item).prepared),
    "hand_empty": Concept(("robot",), lambda w, robot: w.held is None),
    "holding": Concept(("robot", "item"), lambda w, robot, item: w.held == item),
    "held": Concept(("item",), lambda w, item: w.held == item),
    "on": Concept(("item", "object"), lambda w, item, support: w.supports(support, item)),
    "above": Concept(("item", "object"), _above),
    "covered": Concept(("object",), lambda w, name: w.cover(name) is not None),
    "on_ground": Concept(("item",), lambda w, item: item != w.held and w.thing(item).z == 0),
    "on_station": Concept(("item",), _on_station),
    "occupied": Concept(("station",), lambda w, station: any(t.is_item for t in w.stack(w.where(station)))),
    "facing": Concept(("robot", "object"), lambda w, robot, name: name != w.held and w.where(name) == w.faced),
    "adjacent": Concept(("robot", "object"), _adjacent),
    "facing_up": Concept(("robot",), lambda w, robot: w.heading == Heading.UP),
    "facing_left": Concept(("robot",), lambda w, robot: w.heading == Heading.LEFT),
    "facing_down": Concept(("robot",), lambda w, robot: w.heading == Heading.DOWN),
    "facing_right": Concept(("robot",), lambda w, robot: w.heading == Heading.RIGHT),
    "stacked": Concept(("item",), _stacked),
    "top_of_stack": Concept(("item",), lambda w, item: item != w.held and w.cover(item) is None),
}
"""Every word with a ground truth."""

concept_value = TrueWords(CONCEPTS, BurgerWorld.types, lambda given, wanted: TYPE_OF[given].is_a(TYPE_OF[wanted])).value
