"""Random initial worlds (method 10.2): things in distinct edge cells, robot in the middle; scenes of any size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pix2pred.domains.burger.families import BurgerRecipe, SceneContents
from pix2pred.domains.burger.world import EDGE_CELLS, BurgerWorld, Cell, Heading, Thing, edge_cells
from pix2pred.domains.seeds import look
from pix2pred.structs import Application

ROBOT_NAME = "robot"


def initial_world(scene: SceneContents, rng: np.random.Generator, held_z: int = 1) -> BurgerWorld:
    """A uniform shuffle of ``scene`` over the edge cells that are not corners: 12 in the published kitchen.

    ``held_z`` is the z of an item held from the start: 1, or 0 as in the reference (method 10.2). Raises
    ``ValueError`` when there are more things than cells.
    """
    cells = edge_cells(scene.size)
    loose = [(name, kind) for name, kind in scene.things if name != scene.held and name not in scene.start]
    if len(loose) > len(cells):
        raise ValueError(f"{len(loose)} things do not fit {len(cells)} cells")
    order = rng.permutation(len(cells))
    drawn = look(rng)
    placed = {name: Thing(name, kind, cells[order[i]]) for i, (name, kind) in enumerate(loose)}
    middle = Cell(scene.size // 2, scene.size // 2)
    for name, kind in scene.things:
        if name == scene.held:
            placed[name] = Thing(name, kind, middle, held_z)
        elif name in scene.start:
            support = placed[scene.start[name]]
            placed[name] = replace(support, name=name, type=kind, z=support.z + 1)
    return BurgerWorld(ROBOT_NAME, middle, Heading.RIGHT, scene.held, tuple(placed.values()), drawn, scene.size)


def sized_recipe(items: int) -> BurgerRecipe:
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
    return BurgerRecipe(
        f"{items}-items",
        SceneContents(tuple(sorted(things)), {}, held),
        goal or (Application("On", ("patty1", "grill")),),
    )
