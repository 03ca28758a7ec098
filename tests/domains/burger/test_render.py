from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pix2pred.domains.burger.drawing.render import LEVEL, render, render_pixels
from pix2pred.domains.burger.world import BurgerWorld, Cell, Heading, Thing
from pix2pred.structs import Box


def inside(box: Box) -> bool:
    return 0 <= box.left < box.right <= 640 and 0 <= box.top < box.bottom <= 640


def test_same_world_same_pixels_and_other_look_other_pixels(kitchen: BurgerWorld) -> None:
    assert np.array_equal(render_pixels(kitchen), render_pixels(replace(kitchen)))
    other = render_pixels(replace(kitchen, look=8))
    assert (other != render_pixels(kitchen)).any(axis=2).mean() > 0.5


def test_every_object_has_a_box_in_the_picture(kitchen: BurgerWorld) -> None:
    picture = render(kitchen)
    assert set(picture.boxes) == set(kitchen.types())
    assert picture.image.pixels().shape == (640, 640, 3)
    assert all(inside(b) for b in picture.boxes.values())


@pytest.mark.parametrize("row", [0, 4])
def test_tall_stacks_keep_their_boxes_in_the_picture(row: int) -> None:
    things = tuple(Thing(f"patty{i}", "patty", Cell(row, 2), i) for i in range(12))
    world = BurgerWorld("robot", Cell(2, 2), Heading.UP, None, things)
    assert all(inside(b) for b in render(world).boxes.values())


@pytest.mark.parametrize("heading", Heading)
def test_a_held_item_is_small_and_in_the_cell_of_the_robot(kitchen: BurgerWorld, heading: Heading) -> None:
    held = replace(kitchen, held="patty1", heading=heading).changed(
        replace(kitchen.thing("patty1"), cell=kitchen.cell, z=1)
    )
    box = render(held).boxes["patty1"]
    assert 0.28 * 128 < box.width < 0.4 * 128
    assert 256 <= box.left < box.right <= 384
    assert 256 <= box.top < box.bottom <= 384


@pytest.mark.parametrize("above", [("top_bun",), ("lettuce",), ("lettuce", "top_bun"), ("patty", "lettuce", "top_bun")])
@pytest.mark.parametrize("sliced", [False, True])
def test_raw_and_cooked_show_in_every_stack(above: tuple[str, ...], sliced: bool) -> None:
    names = ("bottom_bun", "patty", *above)
    things = [Thing(f"{t}{z}", t, Cell(0, 1), z, t == "lettuce" and sliced) for z, t in enumerate(names)]
    for look in range(3):
        raw = BurgerWorld("robot", Cell(2, 2), Heading.RIGHT, None, tuple(things), look)
        cooked = raw.changed(replace(raw.thing("patty1"), prepared=True))
        changed = (np.abs(render_pixels(raw).astype(int) - render_pixels(cooked)).sum(axis=2) > 60).sum(axis=0)
        assert (changed >= 14).sum() > 40, "a visible strip of at least 14 pixels over half a patty's width"


def test_whole_and_chopped_show_under_a_top_bun() -> None:
    names = ("bottom_bun", "lettuce", "top_bun")
    things = tuple(Thing(f"{t}{z}", t, Cell(0, 1), z) for z, t in enumerate(names))
    whole = BurgerWorld("robot", Cell(2, 2), Heading.RIGHT, None, things)
    chopped = whole.changed(replace(whole.thing("lettuce1"), prepared=True))
    changed = np.abs(render_pixels(whole).astype(int) - render_pixels(chopped)).sum(axis=2) > 60
    assert changed.sum() > 600


def test_stacked_items_rise_by_one_level(kitchen: BurgerWorld) -> None:
    flat = kitchen.changed(replace(kitchen.thing("patty1"), z=0))
    low, high = render(flat).boxes["patty1"], render(kitchen).boxes["patty1"]
    assert low.bottom - high.bottom == LEVEL


def test_only_the_changed_object_changes(kitchen: BurgerWorld) -> None:
    cooked = kitchen.changed(replace(kitchen.thing("patty2"), prepared=True))
    rows, cols = np.nonzero((render_pixels(kitchen) != render_pixels(cooked)).any(axis=2))
    assert {(int(r) // 128, int(c) // 128) for r, c in zip(rows, cols, strict=True)} == {(4, 1)}
