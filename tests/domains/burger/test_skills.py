from __future__ import annotations

from pix2pred.domains.burger.skills import walk
from pix2pred.domains.burger.world import Cell, Heading, Primitive, World


def test_walk_takes_a_shortest_path(kitchen: World) -> None:
    assert walk(kitchen, Cell(0, 2)) == Primitive.move(Heading.UP)
    assert walk(kitchen, Cell(4, 1)) in (Primitive.move(Heading.DOWN), Primitive.move(Heading.LEFT))


def test_walk_goes_round_things_on_the_floor(kitchen: World) -> None:
    patty = kitchen.thing("patty2")
    moved = kitchen.changed(type(patty)(patty.name, patty.type, Cell(1, 2)))
    assert walk(moved, Cell(0, 1)) == Primitive.move(Heading.LEFT)


def test_walk_stands_still_without_a_path(kitchen: World) -> None:
    assert walk(kitchen, Cell(0, 0)) == Primitive()
