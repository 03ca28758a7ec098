"""Test scenes of any size: as many open-face burgers as a number of movable things makes, for generalisation curves."""

from __future__ import annotations

from pix2pred.domains.burger.families import Recipe, Scene
from pix2pred.domains.burger.world import EDGE_CELLS
from pix2pred.structs import Application


def sized_recipe(items: int) -> Recipe:
    """A grill and ``items`` patties and bottom buns, every pair to become an open-face burger.

    An odd patty is left over; a single one is to be put on the grill. When the last thing finds no free cell, the
    robot holds it. Raises ``ValueError`` when the kitchen is too small.
    """
    if not 1 <= items <= len(EDGE_CELLS):
        raise ValueError(f"the kitchen holds 1 to {len(EDGE_CELLS)} movable things, not {items}")
    burgers, spare = divmod(items, 2)
    patties = [f"patty{i}" for i in range(1, burgers + spare + 1)]
    buns = [f"bottom_bun{i}" for i in range(1, burgers + 1)]
    things = [("grill", "grill"), *((p, "patty") for p in patties), *((b, "bottom_bun") for b in buns)]
    goal = tuple(
        Application("SomewhereAboveAndPrepped", (bun, patty)) for bun, patty in zip(buns, patties, strict=False)
    )
    held = patties[-1] if len(things) > len(EDGE_CELLS) else None
    return Recipe(
        f"{items}-items", Scene(tuple(sorted(things)), {}, held), goal or (Application("On", ("patty1", "grill")),)
    )
