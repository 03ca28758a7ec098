"""Localisation by tags: from pictures of rooms alone."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extras import need
from pix2pred.structs.space.poses import FloorPose, Pose

pytestmark = [need("pyapriltags", extra="spot"), need("mujoco", extra="sim")]

POSES = 20
"""In the suite; ``benchmarks/tag_poses.py`` takes a hundred, and more rooms."""


def hung(size: float) -> Any:
    """The map as the tags really hang."""
    from pix2pred.domains.home.roaming.tags import TAGS
    from pix2pred.robots.localising.tag_map import TagMap

    tags = {}
    for tag in TAGS:
        out = np.array([math.cos(tag.facing), math.sin(tag.facing), 0.0])
        right = np.array([-math.sin(tag.facing), math.cos(tag.facing), 0.0])
        axes = np.stack([right, np.array([0.0, 0.0, -1.0]), -out], axis=1)
        tags[tag.number] = Pose(np.array(tag.at) + 0.006 * out, axes)
    return TagMap(size, tags)


def looked(home: Any, finder: Any, place: FloorPose) -> list[Any]:
    from pix2pred.robots.localising.tags import Lens

    home.put_robot(place, Pose.on_floor(place))
    seen = []
    for camera in home.cameras:
        if not camera.in_hand:
            grey = (home.colour(camera.name) @ np.array([0.299, 0.587, 0.114])).astype(np.uint8)
            lens = Lens((camera.focal, camera.focal), (camera.width / 2, camera.height / 2))
            seen += finder.find(grey, camera.pose, lens)
    return seen


@pytest.fixture(scope="module")
def room() -> Any:
    from pix2pred.domains.cleanup import CleanupDomain

    home = CleanupDomain().roaming("new-objects", 3, 0)
    yield home
    home.close()


@pytest.fixture(scope="module")
def finder() -> Any:
    from pix2pred.domains.home.roaming.tags import SIZE
    from pix2pred.robots.localising.tags import TagFinder

    return TagFinder(SIZE)


def random_places(home: Any, count: int, seed: int = 0) -> list[FloorPose]:
    rng = np.random.default_rng(seed)
    places: list[FloorPose] = []
    while len(places) < count:
        x, y, yaw = (float(v) for v in rng.uniform((-1.5, -1.6, -math.pi), (1.8, 1.6, math.pi)))
        if home.stands(FloorPose(x, y, yaw)):
            places.append(FloorPose(x, y, yaw))
    return places


def test_the_place_is_known_to_centimetres_from_nearly_everywhere(room: Any, finder: Any) -> None:
    tags = hung(finder.size)
    good = 0
    for place in random_places(room, POSES):
        fix = tags.locate(looked(room, finder, place))
        if fix is None:
            continue
        off, turn = fix.place.distance(place), fix.place.turn_to(place)
        good += off < 0.05 and turn < math.radians(3)
        assert off < 0.20 or not fix.certain, f"{place}: {off:.2f} m off without saying so"
    assert good >= 0.95 * POSES


def test_a_map_made_on_a_walk_serves_as_well(room: Any, finder: Any) -> None:
    from pix2pred.robots.localising.tag_map import map_from_walk

    walk = [FloorPose(0.0, 0.0, turn) for turn in (0.0, 1.2, 2.4, -2.4, -1.2)] + [FloorPose(-0.4, 0.3, 0.5)]
    walk = [p if room.stands(p) else FloorPose(-0.6, 0.0, p.yaw) for p in walk]
    rng = np.random.default_rng(1)
    felt = [walk[0]] + [p * FloorPose(*(float(v) for v in rng.normal(0, 0.03, 3))) for p in walk[1:]]
    looks = [(f, looked(room, finder, p)) for f, p in zip(felt, walk, strict=True)]
    made = map_from_walk(finder.size, looks)
    assert len(made.tags) == 6
    there = hung(finder.size)
    assert all(np.linalg.norm(made.tags[n].at - there.tags[n].at) < 0.04 for n in made.tags)
    place = random_places(room, 1, 5)[0]
    fix = made.locate(looked(room, finder, place))
    assert fix is not None and fix.place.distance(place) < 0.05


def test_a_tag_that_hangs_elsewhere_makes_the_place_uncertain(room: Any, finder: Any) -> None:
    tags = hung(finder.size)
    moved = dict(tags.tags)
    moved[1] = Pose(moved[1].at + np.array([0.5, 0.0, 0.0]), moved[1].axes)
    seen = looked(room, finder, FloorPose(0.0, 0.0, 0.2))
    assert {1, 5} <= {s.number for s in seen}
    fix = type(tags)(tags.size, moved).locate(seen)
    assert fix is not None and not fix.certain


def test_maps_are_kept_and_damaged_ones_refused(tmp_path: Path, finder: Any) -> None:
    from pix2pred.robots.localising.tag_map import TagMap, TagMapError

    tags = hung(finder.size)
    tags.save(tmp_path / "map.json")
    back = TagMap.load(tmp_path / "map.json")
    assert back.size == tags.size
    assert all(back.tags[n].angle_to(p) < 1e-6 and np.allclose(back.tags[n].at, p.at) for n, p in tags.tags.items())
    (tmp_path / "map.json").write_text("{}")
    with pytest.raises(TagMapError, match="remove it"):
        TagMap.load(tmp_path / "map.json")


def test_no_tag_is_no_map() -> None:
    from pix2pred.robots.localising.tag_map import TagMapError, map_from_walk

    with pytest.raises(TagMapError, match="36h11"):
        map_from_walk(0.3, [(FloorPose(), [])])
