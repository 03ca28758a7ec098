"""Ground truth of visual words, for tests, for training the reader, and for naming failures once they happened."""

from __future__ import annotations

from collections.abc import Mapping

from pix2pred.domains.burger.vocabulary import STATION, TYPE_OF
from pix2pred.domains.burger.world import BurgerWorld, Heading
from pix2pred.domains.words import Concept, TrueWords


def _prepared(world: BurgerWorld, name: str) -> bool:
    return world.thing(name).prepared


def _hand_empty(world: BurgerWorld, robot: str) -> bool:
    return world.held is None


def _holding(world: BurgerWorld, robot: str, item: str) -> bool:
    return world.held == item


def _held(world: BurgerWorld, item: str) -> bool:
    return world.held == item


def _on(world: BurgerWorld, item: str, support: str) -> bool:
    return world.supports(support, item)


def _above(world: BurgerWorld, item: str, support: str) -> bool:
    if world.robot in (item, support) or world.held in (item, support):
        return False
    high, low = world.thing(item), world.thing(support)
    return high.cell == low.cell and high.z > low.z


def _covered(world: BurgerWorld, name: str) -> bool:
    return world.cover(name) is not None


def _on_ground(world: BurgerWorld, item: str) -> bool:
    return item != world.held and world.thing(item).z == 0


def _on_station(world: BurgerWorld, item: str) -> bool:
    thing = world.thing(item)
    return item != world.held and any(
        t.cell == thing.cell and TYPE_OF[t.type].is_a(STATION) for t in world.things if t.name != item
    )


def _occupied(world: BurgerWorld, station: str) -> bool:
    return any(t.is_item for t in world.stack(world.where(station)))


def _facing(world: BurgerWorld, robot: str, name: str) -> bool:
    return name != world.held and world.where(name) == world.faced


def _adjacent(world: BurgerWorld, robot: str, name: str) -> bool:
    return name != world.held and any(world.cell.toward(h) == world.where(name) for h in Heading)


def _faces(heading: Heading) -> Concept:
    def value(world: BurgerWorld, robot: str) -> bool:
        return world.heading == heading

    return Concept(("robot",), value)


def _stacked(world: BurgerWorld, item: str) -> bool:
    return any(
        t.is_item and (world.supports(item, t.name) or world.supports(t.name, item))
        for t in world.things
        if t.name != item
    )


def _top_of_stack(world: BurgerWorld, item: str) -> bool:
    return item != world.held and world.cover(item) is None


CONCEPTS: Mapping[str, Concept] = {
    "cooked": Concept(("patty",), _prepared),
    "chopped": Concept(("lettuce",), _prepared),
    "hand_empty": Concept(("robot",), _hand_empty),
    "holding": Concept(("robot", "item"), _holding),
    "held": Concept(("item",), _held),
    "on": Concept(("item", "object"), _on),
    "above": Concept(("item", "object"), _above),
    "covered": Concept(("object",), _covered),
    "on_ground": Concept(("item",), _on_ground),
    "on_station": Concept(("item",), _on_station),
    "occupied": Concept(("station",), _occupied),
    "facing": Concept(("robot", "object"), _facing),
    "adjacent": Concept(("robot", "object"), _adjacent),
    "facing_up": _faces(Heading.UP),
    "facing_left": _faces(Heading.LEFT),
    "facing_down": _faces(Heading.DOWN),
    "facing_right": _faces(Heading.RIGHT),
    "stacked": Concept(("item",), _stacked),
    "top_of_stack": Concept(("item",), _top_of_stack),
}
"""Every word with a ground truth."""

concept_value = TrueWords(CONCEPTS, BurgerWorld.types, lambda given, wanted: TYPE_OF[given].is_a(TYPE_OF[wanted])).value
