from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.domains.burger.families import SceneContents
from pix2pred.domains.burger.scenes import initial_world
from pix2pred.domains.burger.world import EDGE_CELLS, BurgerPrimitive, BurgerWorld, Cell, Heading, advance


def test_edge_cells_are_twelve_and_no_corner() -> None:
    assert len(set(EDGE_CELLS)) == 12
    assert all((c.row in (0, 4)) != (c.col in (0, 4)) for c in EDGE_CELLS)


def test_moving_turns_and_stops_before_the_edge(kitchen: BurgerWorld) -> None:
    up = advance(kitchen, BurgerPrimitive.move(Heading.UP))
    assert (up.cell, up.heading) == (Cell(1, 2), Heading.UP)
    blocked = advance(up, BurgerPrimitive.move(Heading.UP))
    assert blocked == up
    left = advance(up, BurgerPrimitive(turn=Heading.LEFT))
    assert (left.cell, left.heading) == (Cell(1, 2), Heading.LEFT)


def test_moving_into_an_occupied_interior_cell_only_turns(kitchen: BurgerWorld) -> None:
    blocked = kitchen.changed(replace(kitchen.thing("patty2"), cell=Cell(2, 1)))
    moved = advance(blocked, BurgerPrimitive.move(Heading.LEFT))
    assert (moved.cell, moved.heading) == (Cell(2, 2), Heading.LEFT)


def test_pick_takes_the_topmost_and_it_moves_along(kitchen: BurgerWorld) -> None:
    beside = replace(kitchen, cell=Cell(2, 1), heading=Heading.LEFT)
    picked = advance(beside, BurgerPrimitive(toggle=True))
    assert picked.held == "patty1"
    assert (picked.thing("patty1").cell, picked.thing("patty1").z) == (Cell(2, 1), 1)
    assert picked.stack(Cell(2, 0)) == (kitchen.thing("bottom_bun1"),)
    moved = advance(picked, BurgerPrimitive.move(Heading.RIGHT))
    assert moved.thing("patty1").cell == moved.cell == Cell(2, 2)
    assert advance(picked, BurgerPrimitive(toggle=True)) == beside


def test_place_on_the_floor_has_level_zero(kitchen: BurgerWorld) -> None:
    beside = replace(kitchen, cell=Cell(2, 1), heading=Heading.LEFT)
    picked = advance(beside, BurgerPrimitive(toggle=True))
    dropped = advance(replace(picked, heading=Heading.RIGHT), BurgerPrimitive(toggle=True))
    assert dropped.held is None
    assert (dropped.thing("patty1").cell, dropped.thing("patty1").z) == (Cell(2, 2), 0)


def test_stations_and_empty_cells_cannot_be_picked(kitchen: BurgerWorld) -> None:
    at_grill = replace(kitchen, cell=Cell(1, 2), heading=Heading.UP)
    assert advance(at_grill, BurgerPrimitive(toggle=True)) == at_grill
    at_nothing = replace(kitchen, cell=Cell(1, 1), heading=Heading.UP)
    assert advance(at_nothing, BurgerPrimitive(toggle=True, interact=True)) == at_nothing


@pytest.mark.parametrize(
    ("station", "item", "changes"),
    [("grill", "patty2", True), ("grill", "lettuce1", False),
     ("cutting_board", "lettuce1", True), ("cutting_board", "patty2", False)],
)  # fmt: skip
def test_interact_prepares_what_lies_on_its_station(
    kitchen: BurgerWorld, station: str, item: str, changes: bool
) -> None:
    cell = kitchen.where(station)
    ready = kitchen.changed(replace(kitchen.thing(item), cell=cell, z=1))
    ready = replace(ready, cell=cell.toward(Heading.DOWN), heading=Heading.UP)
    assert advance(ready, BurgerPrimitive(interact=True)).thing(item).prepared is changes


def test_interact_reaches_only_the_item_directly_on_the_grill(kitchen: BurgerWorld) -> None:
    stacked = kitchen.changed(
        replace(kitchen.thing("patty1"), cell=Cell(0, 2), z=1), replace(kitchen.thing("patty2"), cell=Cell(0, 2), z=2)
    )
    after = advance(replace(stacked, cell=Cell(1, 2), heading=Heading.UP), BurgerPrimitive(interact=True))
    assert after.thing("patty1").prepared
    assert not after.thing("patty2").prepared


def test_diagonal_moves_are_refused(kitchen: BurgerWorld) -> None:
    with pytest.raises(ValueError, match="one axis"):
        advance(kitchen, BurgerPrimitive(dcol=1, drow=1))


PRIMITIVES = st.one_of(
    st.sampled_from([BurgerPrimitive.move(h) for h in Heading]),
    st.builds(BurgerPrimitive, turn=st.sampled_from([-1, 0, 1, 2, 3]), interact=st.booleans(), toggle=st.booleans()),
)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 999), primitives=st.lists(PRIMITIVES, max_size=40))
def test_any_history_keeps_the_world_in_order(seed: int, primitives: list[BurgerPrimitive]) -> None:
    kinds = ("patty", "lettuce", "top_bun", "bottom_bun", "cheese")
    scene = SceneContents((("cutting_board", "cutting_board"), ("grill", "grill"), *((f"{k}1", k) for k in kinds)))
    world = initial_world(scene, np.random.default_rng(seed))
    for primitive in primitives:
        world = advance(world, primitive)
        assert world.walkable(world.cell)
        assert world.held is None or world.thing(world.held).cell == world.cell
        for cell in {t.cell for t in world.things}:
            assert [t.z for t in world.stack(cell)] == list(range(len(world.stack(cell))))
        assert BurgerWorld.from_dict(json.loads(json.dumps(world.to_dict()))) == world


@pytest.mark.parametrize(
    "change",
    [{"held": "nobody"}, {"held": "grill"}, {"look": "x"}, {"robot": {"name": "robot", "row": 0, "col": 2, "dir": 0}},
     {"robot": {"name": "robot", "row": 2, "col": 2, "dir": 9}},
     {"robot": {"name": "grill", "row": 2, "col": 2, "dir": 0}},
     {"things": [{"name": "x", "type": "pizza", "row": 0, "col": 1, "z": 0, "prepared": False}]},
     {"things": [{"name": "x", "type": "patty", "row": 0, "col": 7, "z": 0, "prepared": False}]},
     {"things": [{"name": "x"}]}, {"things": None}],
)  # fmt: skip
def test_a_broken_description_is_refused(kitchen: BurgerWorld, change: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="not a burger simulator state"):
        BurgerWorld.from_dict(kitchen.to_dict() | change)
