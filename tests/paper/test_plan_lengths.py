"""Plan lengths with the printed operators (method 12.1), and the structural laws of all 60 (12.3)."""

from __future__ import annotations

import pytest

import golden
from pix2pred.planning import AStar, GreedyBestFirst, Planner, is_valid
from pix2pred.structs import Atom, Object, PlanStatus

HAND_FREE = {
    "more_burger_stacks": "empty_hands0",
    "bigger_burger": "[[0:robot].fingers<=[idx_0]0.5]",
    "combo_burger": "clear5",
}
ABOVE, RIGHT = "SomewhereAboveAndPrepped", "RightAboveAndPrepped"


def _burger(model: str, items: str, held: str | None, goal: str) -> tuple[dict[str, Object], set[Atom], list[Atom]]:
    things = golden.objects("robot:robot grill:grill cutting_board:cutting_board " + items)

    def atom(text: str) -> Atom:
        name, *args = text.split()
        return Atom(golden.printed(name), tuple(things[a] for a in args))

    facts = {"Clear robot", "Clear grill", "Clear cutting_board"}
    for name, thing in things.items():
        if thing.type.name in ("robot", "grill", "cutting_board"):
            continue
        facts |= {f"Holding robot {name}"} if name == held else {f"Clear {name}", f"OnGround {name}"}
    if held is None:
        facts.add(f"{HAND_FREE[model]} robot")
    return things, {atom(f) for f in facts}, [atom(g) for g in goal.split(", ")]


def _n(kinds: str, count: int) -> str:
    return " ".join(f"{kind}{i}:{kind}" for kind in kinds.split() for i in range(1, count + 1))


def _open_face(count: int) -> str:
    return ", ".join(f"{ABOVE} bottom_bun{i} patty{i}" for i in range(1, count + 1))


DEFAULT = _n("patty lettuce cheese top_bun bottom_bun", 1)
LETTUCE_BURGER = f"{ABOVE} bottom_bun1 patty1, {ABOVE} patty1 lettuce1, On top_bun1 lettuce1"
TWO = LETTUCE_BURGER + ", " + LETTUCE_BURGER.replace("1", "2")
CASES = [
    ("more_burger_stacks", _n("patty bottom_bun", 5), None, _open_face(5), 25),
    ("more_burger_stacks", _n("patty bottom_bun", 6), "patty6", _open_face(6), 29),
    (
        "bigger_burger",
        DEFAULT + " patty2:patty",
        None,
        f"{ABOVE} bottom_bun1 patty1, {RIGHT} patty1 patty2, On top_bun1 patty2",
        12,
    ),
    (
        "bigger_burger",
        DEFAULT + " patty2:patty patty3:patty bottom_bun2:bottom_bun",
        "patty3",
        f"{ABOVE} bottom_bun1 patty1, {RIGHT} patty1 patty2, On top_bun1 patty2, {ABOVE} bottom_bun2 patty3",
        16,
    ),
    ("combo_burger", DEFAULT, None, LETTUCE_BURGER, 12),
    (
        "combo_burger",
        DEFAULT + " patty2:patty bottom_bun2:bottom_bun",
        "patty2",
        LETTUCE_BURGER + f", {ABOVE} bottom_bun2 patty2",
        16,
    ),
    ("combo_burger", _n("patty bottom_bun top_bun lettuce", 2), None, TWO, 24),
    (
        "combo_burger",
        _n("patty bottom_bun top_bun", 3) + " lettuce1:lettuce lettuce2:lettuce",
        "patty3",
        TWO + f", {ABOVE} bottom_bun3 patty3, On top_bun3 patty3",
        30,
    ),
]


@pytest.mark.parametrize(("model", "items", "held", "goal", "length"), CASES)
def test_shortest_plans_have_the_computed_lengths(
    model: str, items: str, held: str | None, goal: str, length: int
) -> None:
    things, initial, wanted = _burger(model, items, held, goal)
    operators = golden.load_operators(model)
    for search in (AStar(), GreedyBestFirst()):
        found = Planner(search).plan(operators, things.values(), frozenset(initial), wanted)
        assert found.status == PlanStatus.SOLVED
        assert is_valid(found.plan, frozenset(initial), wanted)
        assert len(found.plan) == length if isinstance(search, AStar) else len(found.plan) >= length


@pytest.mark.parametrize("model", golden.MODELS)
def test_printed_operators_obey_the_structural_laws(model: str) -> None:
    for operator in golden.load_operators(model):
        assert list(operator.broken_laws()) == []
