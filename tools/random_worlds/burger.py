"""Worlds of any arrangement, for training and judging the offline reader: stacks, held items, prepared or not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pix2pred.domains.burger.scenes import ROBOT_NAME
from pix2pred.domains.burger.world import EDGE_CELLS, SIZE, BurgerWorld, Cell, Heading, Thing
from random_worlds.looks import worlds_of_looks

_ITEM_KINDS = ("patty", "lettuce", "cheese", "bottom_bun", "top_bun")
_STACKED = 0.5
_HELD = 0.45
_FACING = 0.5
_TALLEST = 5
_INTERIOR = [Cell(r, c) for r in range(1, SIZE - 1) for c in range(1, SIZE - 1)]


def random_world(rng: np.random.Generator, look: int) -> BurgerWorld:
    """A random scene of one or two stations and three to eleven items, drawn in the look seeded by ``look``.

    Half of the items lie on others or on stations; in 45 % of the worlds the robot holds one.
    """
    stations = ["grill", "cutting_board"] if rng.random() < 0.7 else ["grill"]
    kinds = [str(k) for k in rng.choice(_ITEM_KINDS, size=int(rng.integers(3, 12)), p=(0.3, 0.2, 0.08, 0.22, 0.2))]
    free = [EDGE_CELLS[i] for i in rng.permutation(len(EDGE_CELLS))]
    stacks: list[list[Thing]] = [[Thing(name, name, free.pop())] for name in stations]
    counts: dict[str, int] = {}
    for kind in kinds:
        counts[kind] = counts.get(kind, 0) + 1
        prepared = kind in ("patty", "lettuce") and bool(rng.random() < 0.5)
        open_stacks = [s for s in stacks if len(s) < _TALLEST]
        if not free or (rng.random() < _STACKED and open_stacks):
            stack = open_stacks[int(rng.integers(len(open_stacks)))]
            stack.append(Thing(f"{kind}{counts[kind]}", kind, stack[0].cell, stack[-1].z + 1, prepared))
        else:
            stacks.append([Thing(f"{kind}{counts[kind]}", kind, free.pop(), 0, prepared)])
    robot_cell, heading = _robot_pose(rng, stacks)
    things = {t.name: t for stack in stacks for t in stack}
    held = None
    if rng.random() < _HELD:
        tops = sorted(stack[-1].name for stack in stacks if stack[-1].is_item)
        if tops:
            held = tops[int(rng.integers(len(tops)))]
            things[held] = replace(things[held], cell=robot_cell, z=1)
    return BurgerWorld(ROBOT_NAME, robot_cell, heading, held, tuple(things.values()), look)


def _robot_pose(rng: np.random.Generator, stacks: Sequence[Sequence[Thing]]) -> tuple[Cell, Heading]:
    """Half of the time in front of a stack, facing it; else anywhere, looking anywhere."""
    if rng.random() < _FACING:
        target = stacks[int(rng.integers(len(stacks)))][0].cell
        for heading in Heading:
            cell = next((c for c in _INTERIOR if c.toward(heading) == target), None)
            if cell is not None:
                return cell, heading
    return _INTERIOR[int(rng.integers(len(_INTERIOR)))], Heading(int(rng.integers(4)))


def random_worlds(seed: int, looks: int, per_look: int) -> list[BurgerWorld]:
    """``looks`` differently drawn scenes with ``per_look`` arrangements each, apart from demonstrations and tasks."""
    return worlds_of_looks(random_world, seed, looks, per_look)
