from __future__ import annotations

import copy
import json
from typing import Any

import pytest

from pix2pred.domains.home.world import Body, Thing, World


@pytest.fixture
def world() -> World:
    things = (
        Thing("wide_bin", "trash_can", "wide_bin", 2, (0.5, -0.6, 0.0)),
        Thing("ball", "movable_object", "ball", 3, (0.5, 0.1, 0.05)),
        Thing("desk", "table", "table", 1, (1.1, 0.0, 0.0), strokes=(0, 2)),
        Thing("counter", "scenery", "counter", 1, (3.0, 0.0, 0.0)),
    )
    return World(things, Body.ROBOT, 5, "office", "ball", "ball")


def test_scenery_is_no_object_and_the_actor_is_one(world: World) -> None:
    assert world.types() == {
        "robot": "robot", "ball": "movable_object", "desk": "table", "wide_bin": "trash_can",
    }  # fmt: skip
    assert World((), Body.HUMAN).types() == {"hand": "robot"}


def test_a_world_survives_json(world: World) -> None:
    assert World.from_dict(json.loads(json.dumps(world.to_dict()))) == world


def _broken(data: dict[str, Any], path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    changed = copy.deepcopy(data)
    place: Any = changed
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return changed


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("things", 0, "at"), [0.0, float("nan"), 0.0]),
        (("things", 0, "at"), [0.0, 1.0]),
        (("things", 0, "turn"), [0.0, 0.0, 0.0, 0.0]),
        (("things", 0, "amount"), 1.5),
        (("things", 1, "name"), "ball"),
        (("things", 1, "name"), "robot"),
        (("body",), "cat"),
        (("holding",), "nothing"),
        (("things",), 3),
        (("room",), None),
    ],
)
def test_impossible_worlds_are_refused(world: World, path: tuple[Any, ...], value: Any) -> None:
    with pytest.raises(ValueError, match="not a simulator state"):
        World.from_dict(_broken(world.to_dict(), path, value))
