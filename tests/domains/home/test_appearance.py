"""What objects are called where pictures are talked about: by their looks, each by a phrase of its own."""

from __future__ import annotations

from dataclasses import replace

import pytest

from extras import need
from pix2pred.domains.cleanup import CleanupDomain
from pix2pred.domains.home.appearance import described
from pix2pred.domains.home.domain import HomeDomain
from pix2pred.domains.home.drawing.movables import BRIGHT, BRIGHT_NAMES
from pix2pred.domains.home.drawing.vessels import vessel_colour
from pix2pred.domains.home.world import Body, Thing, World
from pix2pred.domains.juice import JuiceDomain

pytestmark = need("mujoco", extra="sim")
DOMAINS: tuple[HomeDomain, ...] = (CleanupDomain(), JuiceDomain())


@pytest.mark.parametrize("domain", DOMAINS, ids=lambda d: d.name)
def test_every_object_of_a_task_has_a_phrase_of_its_own_that_says_what_one_sees(domain: HomeDomain) -> None:
    for family in domain.families:
        objects = domain.rules.objects(domain.start(family, 4, 1).world)
        assert len({o.prompt_name for o in objects}) == len(objects)
        assert not any(told in o.descriptor for o in objects for told in ("juice cup", "waste", "desk", "other", "_"))


def test_cups_are_called_by_colour_and_others_by_colour_or_place_where_they_are_several() -> None:
    def thing(name: str, kind: str, look: int, x: float = 1.0, y: float = 0.0) -> Thing:
        return Thing(name, "container" if kind in ("glass", "bowl") else "movable_object", kind, look, (x, y, 0.0))

    things = [
        thing("a", "glass", 1),
        thing("b", "bowl", 1, y=0.3),
        thing("c", "bowl", 1, y=-0.3),
        thing("d", "duck", 1),
    ]
    balls = [thing("e", "ball", 1), thing("f", "ball", 3)]
    rows = [thing(f"can{i}", "can", 7, 1.0 + 0.5 * (i > 3), -0.1 * i) for i in range(5)]
    phrases = described(World((*things, *balls, *rows), Body.ROBOT)).phrases()
    assert [phrases[n] for n in "abcd"] == ["glass", "left bowl", "right bowl", "duck"]
    assert {phrases["e"], phrases["f"]} <= {f"{colour} ball" for colour in BRIGHT_NAMES} and phrases["e"] != phrases[
        "f"
    ]
    assert phrases["can2"].startswith("front ") and phrases["can2"].endswith(" can number 3 from the left")
    assert phrases["can4"].startswith("back ") and phrases["robot"] == "robot"


@pytest.mark.parametrize("look", range(12))
def test_a_cup_is_called_by_the_bright_colour_that_is_nearest_to_its_own(look: int) -> None:
    named = vessel_colour(Thing("cup", "container", "plastic_cup", look))
    away = [sum((a - b) ** 2 for a, b in zip(named.colour, bright, strict=True)) for bright in BRIGHT]
    assert named.name == BRIGHT_NAMES[away.index(min(away))]


def test_a_phrase_stays_when_its_object_is_moved_and_stored_worlds_without_phrases_are_read() -> None:
    world = DOMAINS[1].start("novel-goal-2", 0, 0).world
    cup = world.thing("juice_cup")
    moved = world.with_thing(replace(cup, at=(0.7, 0.5, cup.at[2])))
    assert moved.phrases() == world.phrases() == World.from_dict(world.to_dict()).phrases()
    stored = world.to_dict()
    for told in stored["things"]:
        del told["seen_as"]
    assert World.from_dict(stored).phrases()["juice_cup"] == "juice cup"
