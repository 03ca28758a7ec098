"""The larger kitchen: twelve burgers on 9 x 9 cells, planned with what more-stacks shows."""

from __future__ import annotations

from functools import cache

import pytest

from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger.drawing.render import render
from pix2pred.domains.burger.environment import BurgerEnvironment
from pix2pred.domains.burger.truth import concept_value
from pix2pred.domains.burger.vocabulary import SHARED, SKILL_OF, make_object
from pix2pred.domains.burger.world import BurgerWorld, Cell, Heading, Thing, edge_cells
from pix2pred.structs import Action
from pix2pred.structs.environment import SimulatedTask, StepStatus
from pix2pred.vlm.offline.model import ReaderModel

DOMAIN = BurgerDomain()


@cache
def task(index: int) -> SimulatedTask:
    return DOMAIN.tasks("banquet", 0, 2)[index]


def world_of(simulated: SimulatedTask) -> BurgerWorld:
    return BurgerWorld.from_dict(simulated.simulator["world"])


def test_the_kitchen_has_room_for_everything_and_its_picture_the_scale_of_the_small_one() -> None:
    world = world_of(task(0))
    assert world.size == 9 and len(world.things) == len(edge_cells(9)) == 28
    picture = task(0).task.initial.pictures[0]
    assert picture.image.pixels().shape == (1152, 1152, 3)
    small = render(BurgerWorld("robot", Cell(2, 2), Heading.RIGHT, None, (Thing("grill", "grill", Cell(0, 2)),), 7))
    assert picture.boxes["grill"].width == small.boxes["grill"].width


def test_twelve_patties_share_one_grill_and_one_is_held() -> None:
    types = [t.type for t in world_of(task(1)).things]
    assert {kind: types.count(kind) for kind in sorted(set(types))} == {
        "bottom_bun": 12, "grill": 1, "patty": 12, "top_bun": 4,
    }  # fmt: skip
    assert world_of(task(1)).held == "patty12"


def test_it_has_the_demonstrations_of_more_stacks() -> None:
    ours, theirs = (DOMAIN.demonstration_starts(family, 3) for family in ("banquet", "more-stacks"))
    assert [t.simulator for t in ours] == [t.simulator for t in theirs]


def test_a_world_says_its_size_only_where_it_is_not_the_published_one() -> None:
    large = world_of(task(0))
    assert large.to_dict()["size"] == 9 and BurgerWorld.from_dict(large.to_dict()) == large
    small = world_of(DOMAIN.tasks("more-stacks", 0, 1)[0])
    assert "size" not in small.to_dict()


@pytest.mark.parametrize("size", [4, 16, 0])
def test_a_kitchen_of_another_size_is_refused(size: int) -> None:
    with pytest.raises(ValueError, match="cells a side"):
        BurgerWorld.from_dict({**world_of(task(0)).to_dict(), "size": size})


def test_the_robot_walks_through_the_whole_interior_and_an_episode_is_as_long_for_every_cell() -> None:
    things = (Thing("bun", "bottom_bun", Cell(0, 1)), Thing("patty", "patty", Cell(8, 7)))
    world = BurgerWorld("robot", Cell(4, 4), Heading.RIGHT, None, things, 7, 9)
    robot, patty, bun = (make_object(n, t) for n, t in (("robot", "robot"), ("patty", "patty"), ("bun", "bottom_bun")))
    actions = [Action(SKILL_OF["Pick"], (robot, patty)), Action(SKILL_OF["Place"], (robot, patty, bun))]
    episode = BurgerEnvironment(world, SHARED, ())
    assert [episode.execute(a).status for a in actions] == [StepStatus.DONE] * 2
    assert episode.world.thing("patty").cell == Cell(0, 1) and episode.steps > 2 * 6
    late = BurgerEnvironment(world, SHARED, ())
    late.steps = 8 * 9 * 9 - 2
    assert late.execute(actions[0]).status is StepStatus.HORIZON
    assert late.steps == 8 * 9 * 9


def test_the_reader_of_the_small_kitchen_reads_the_large_one() -> None:
    assert DOMAIN.reader is not None
    model = ReaderModel.load(DOMAIN.reader)
    world = world_of(task(0))
    for skill, args in (("Pick", ("patty1",)), ("Place", ("patty1", "grill")), ("Cook", ("patty1", "grill"))):
        episode = BurgerEnvironment(world, SHARED, ())
        types = world.types()
        objects = tuple(make_object(n, types[n]) for n in ("robot", *args))
        assert episode.execute(Action(SKILL_OF[skill], objects)).status is StepStatus.DONE
        world = episode.world
    scene, types, wrong = model.words.scene(render(world), world.types()), world.types(), []
    for word, signature in model.words.uses():
        if word.concept is None or (len(signature) > 1 and signature[0] == "robot"):
            continue  # how far the robot is from things is a distance
        for a in (n for n, t in types.items() if t == signature[0]):
            for names in (
                [(a, b) for b, t in types.items() if t == signature[1] and b != a] if signature[1:] else [(a,)]
            ):
                value, _ = model.value(word.word, names, signature, scene)
                if value != (concept_value(world, word.concept, names) != word.negated):
                    wrong.append((word.word, *names))
    assert wrong == []
