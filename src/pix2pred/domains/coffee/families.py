"""The task families (method 10.3): five demonstrations that all share, and test tasks with more cups."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pix2pred.domains.coffee.classifiers import AboveCup


@dataclass(frozen=True, slots=True)
class CoffeeRecipe:
    """What a demonstration shows.

    As many ``cups`` are filled; a jug that is ``turned_away`` has to be turned before it can be taken.
    """

    cups: int
    turned_away: bool

    @property
    def name(self) -> str:
        """A name for files."""
        return f"{self.cups}-cup" + ("-turned" if self.turned_away else "")

    @property
    def skills(self) -> tuple[tuple[str, ...], ...]:
        """Skill names and their arguments after the robot, in order."""
        return (
            *([("RotateItemUntilHandleAccessible", "jug")] if self.turned_away else []),
            ("PickJug", "jug"),
            ("PlaceJugInMachine", "jug", "coffee_machine"),
            ("TurnMachineOnAndFill", "coffee_machine"),
            ("PickJug", "jug"),
            *(("PourSomeLiquid", "jug", f"cup{i}") for i in reversed(range(self.cups))),
        )


DEMONSTRATIONS = (
    CoffeeRecipe(2, False),
    CoffeeRecipe(1, True),
    CoffeeRecipe(1, False),
    CoffeeRecipe(1, True),
    CoffeeRecipe(1, False),
)
"""Two cups first: the printed operators are numbered in this order (method 12.2)."""


@dataclass(frozen=True, slots=True)
class CoffeeFamily:
    """How many cups the test tasks have, and when the jug counts as above a cup."""

    test_cups: int
    above: AboveCup = AboveCup.ANYWHERE


FAMILIES: Mapping[str, CoffeeFamily] = {
    "three-cups": CoffeeFamily(3),
    "four-cups": CoffeeFamily(4),
    "five-cups": CoffeeFamily(5),
    "six-cups": CoffeeFamily(6),
    "three-cups-near": CoffeeFamily(3, AboveCup.NEAR),
}
"""All families have the same demonstrations for equal seeds; ``-near`` differs in the given above-cup predicates."""
