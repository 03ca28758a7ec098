from __future__ import annotations

from dataclasses import replace
from itertools import product

import pytest

from pix2pred.domains.burger.truth import CONCEPTS, concept_value
from pix2pred.domains.burger.vocabulary import TYPE_OF
from pix2pred.domains.burger.world import BurgerWorld, Cell, Heading


def true_of(world: BurgerWorld) -> set[str]:
    found = set()
    for concept, meaning in CONCEPTS.items():
        pools = [[n for n, t in world.types().items() if TYPE_OF[t].is_a(TYPE_OF[w])] for w in meaning.types]
        for names in product(*pools):
            if len(set(names)) == len(names) and concept_value(world, concept, names):
                found.add(f"{concept}({', '.join(names)})")
    return found


def test_hand_worked_scene(kitchen: BurgerWorld) -> None:
    world = replace(kitchen, cell=Cell(2, 3)).changed(replace(kitchen.thing("patty1"), prepared=True))
    assert true_of(world) == {
        "cooked(patty1)", "hand_empty(robot)", "on(patty1, bottom_bun1)", "above(patty1, bottom_bun1)",
        "covered(bottom_bun1)", "on_ground(bottom_bun1)", "on_ground(lettuce1)", "on_ground(patty2)",
        "facing(robot, cutting_board)", "adjacent(robot, cutting_board)", "facing_right(robot)",
        "stacked(patty1)", "stacked(bottom_bun1)", "top_of_stack(patty1)", "top_of_stack(patty2)",
        "top_of_stack(lettuce1)",
    }  # fmt: skip


def test_holding_scene(kitchen: BurgerWorld) -> None:
    world = replace(kitchen, held="patty1", heading=Heading.UP).changed(
        replace(kitchen.thing("patty1"), cell=Cell(2, 2), z=1),
        replace(kitchen.thing("lettuce1"), cell=Cell(2, 4), z=1, prepared=True),
        replace(kitchen.thing("patty2"), cell=Cell(2, 4), z=2),
    )
    assert true_of(world) == {
        "chopped(lettuce1)", "held(patty1)", "holding(robot, patty1)", "on(lettuce1, cutting_board)",
        "on(patty2, lettuce1)", "above(lettuce1, cutting_board)", "above(patty2, cutting_board)",
        "above(patty2, lettuce1)", "covered(cutting_board)", "covered(lettuce1)", "on_ground(bottom_bun1)",
        "on_station(lettuce1)", "on_station(patty2)", "occupied(cutting_board)", "facing_up(robot)",
        "stacked(lettuce1)", "stacked(patty2)", "top_of_stack(bottom_bun1)", "top_of_stack(patty2)",
    }  # fmt: skip


@pytest.mark.parametrize(("concept", "names"), [("tasty", ("patty1",)), ("cooked", ("lettuce1",)), ("on", ("patty1",))])
def test_what_does_not_fit_is_refused(kitchen: BurgerWorld, concept: str, names: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match=concept):
        concept_value(kitchen, concept, names)
