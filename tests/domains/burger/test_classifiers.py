from __future__ import annotations

from dataclasses import replace

import pytest

from pix2pred.domains.burger.classifiers import holds, true_atoms
from pix2pred.domains.burger.families import load_families
from pix2pred.domains.burger.vocabulary import ITEM, composites, make_object, printed_name
from pix2pred.domains.burger.world import BurgerWorld, Cell
from pix2pred.structs import Atom, Demo, FromHuman, Predicate


def texts(world: BurgerWorld, family: str = "bigger") -> set[str]:
    return {str(a) for a in true_atoms(world, load_families()[family].initial)}


def test_hand_worked_scene(kitchen: BurgerWorld) -> None:
    assert texts(kitchen) == {
        "On(patty1, bottom_bun1)", "OnGround(bottom_bun1)", "OnGround(lettuce1)", "OnGround(patty2)",
        "Clear(robot)", "Clear(grill)", "Clear(cutting_board)", "Clear(patty1)", "Clear(patty2)", "Clear(lettuce1)",
    }  # fmt: skip


def test_holding_scene(kitchen: BurgerWorld) -> None:
    held = replace(kitchen, held="patty1").changed(replace(kitchen.thing("patty1"), cell=Cell(2, 2), z=1))
    found = texts(held)
    assert {"Holding(robot, patty1)", "Clear(robot)", "Clear(bottom_bun1)"} <= found
    assert not {"Clear(patty1)", "OnGround(patty1)", "On(patty1, robot)"} & found


def test_composites_take_the_support_first(kitchen: BurgerWorld) -> None:
    world = kitchen.changed(
        replace(kitchen.thing("patty1"), prepared=True),
        replace(kitchen.thing("patty2"), cell=Cell(2, 0), z=2, prepared=True),
    )
    found = texts(world)
    assert "RightAboveAndPrepped2(patty1, patty2)" in found
    assert "RightAboveAndPrepped2(patty2, patty1)" not in found
    assert {"SomewhereAboveAndPrepped(bottom_bun1, patty1)", "SomewhereAboveAndPrepped(bottom_bun1, patty2)"} <= found
    on_board = kitchen.changed(replace(kitchen.thing("patty2"), cell=Cell(2, 4), z=1, prepared=True))
    assert "RightAboveAndPrepped0(cutting_board, patty2)" in texts(on_board)


def test_raw_never_counts(kitchen: BurgerWorld) -> None:
    assert not any("Prepped" in text for text in texts(kitchen))


def test_clear_robot_in_every_state(demos: dict[str, tuple[Demo, ...]]) -> None:
    for family in demos.values():
        for demo in family:
            for state in demo.states:
                assert "Clear(robot)" in {str(a) for a in state.given}


def test_names_are_unique_and_numbered_by_sorted_types() -> None:
    names = [p.signature for p in load_families()["bigger"].initial]
    assert names == [
        "On(item, object)", "OnGround(item)", "Clear(object)", "Holding(robot, item)",
        "RightAboveAndPrepped0(cutting_board, patty)", "RightAboveAndPrepped1(grill, patty)",
        "RightAboveAndPrepped2(patty, patty)", "SomewhereAboveAndPrepped(bottom_bun, patty)",
    ]  # fmt: skip
    combo = composites(
        {"SomewhereAboveAndPrepped": [("patty", "lettuce"), ("bottom_bun", "patty"), ("bottom_bun", "lettuce")]}
    )
    assert [p.signature for p in combo] == [
        "SomewhereAboveAndPrepped0(bottom_bun, lettuce)", "SomewhereAboveAndPrepped1(bottom_bun, patty)",
        "SomewhereAboveAndPrepped2(patty, lettuce)",
    ]  # fmt: skip
    assert printed_name("SomewhereAboveAndPrepped12") == "SomewhereAboveAndPrepped"


def test_a_foreign_predicate_is_refused(kitchen: BurgerWorld) -> None:
    atom = Atom(Predicate("Shiny", (ITEM,), FromHuman()), (make_object("patty1", "patty"),))
    with pytest.raises(ValueError, match="Shiny"):
        holds(kitchen, atom)
