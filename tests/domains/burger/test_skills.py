from __future__ import annotations

from pix2pred.domains.burger.skills import walk
from pix2pred.domains.burger.world import BurgerPrimitive, BurgerWorld, Cell, Heading


def test_walk_takes_a_shortest_path(kitchen: BurgerWorld) -> None:
    assert walk(kitchen, Cell(0, 2)) == BurgerPrimitive.move(Heading.UP)
    assert walk(kitchen, Cell(4, 1)) in (BurgerPrimitive.move(Heading.DOWN), BurgerPrimitive.move(Heading.LEFT))


def test_walk_goes_round_things_on_the_floor(kitchen: BurgerWorld) -> None:
    patty = kitchen.thing("patty2")
    moved = kitchen.changed(type(patty)(patty.name, patty.type, Cell(1, 2)))
    assert walk(moved, Cell(0, 1)) == BurgerPrimitive.move(Heading.LEFT)


def test_walk_stands_still_without_a_path(kitchen: BurgerWorld) -> None:
    assert walk(kitchen, Cell(0, 0)) == BurgerPrimitive()
