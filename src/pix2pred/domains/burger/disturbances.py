"""What may happen between skills when an episode is disturbed: an item is moved, dropped, or two are swapped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pix2pred.domains.burger.world import BurgerWorld, Thing, edge_cells


class Disturbances:
    """After each skill, with probability ``rate``, one random event. Deterministic for a seed."""

    def __init__(self, rate: float, seed: tuple[int, ...]) -> None:
        if not 0 <= rate <= 1:
            raise ValueError(f"the rate of disturbances must be between 0 and 1, found {rate}")
        self._rate = rate
        self._seed = seed
        self.reset()

    def reset(self) -> None:
        """Start the sequence of events over."""
        self._rng = np.random.default_rng(np.random.SeedSequence(self._seed))

    def __call__(self, world: BurgerWorld) -> BurgerWorld:
        """The world after what may have happened."""
        if self._rng.random() >= self._rate:
            return world
        kinds = [events for events in (_drops(world), _moves(world), _swaps(world)) if events]
        if not kinds:
            return world
        events = kinds[int(self._rng.integers(len(kinds)))]
        return events[int(self._rng.integers(len(events)))]


def _moves(world: BurgerWorld) -> list[BurgerWorld]:
    """A top item lies on another free edge cell."""
    return [
        world.changed(replace(top, cell=cell, z=0))
        for top in _tops(world)
        for cell in edge_cells(world.size)
        if not world.stack(cell)
    ]


def _drops(world: BurgerWorld) -> list[BurgerWorld]:
    """The held item falls onto a free edge cell."""
    if world.held is None:
        return []
    held = world.thing(world.held)
    return [
        replace(world.changed(replace(held, cell=cell, z=0)), held=None)
        for cell in edge_cells(world.size)
        if not world.stack(cell)
    ]


def _swaps(world: BurgerWorld) -> list[BurgerWorld]:
    """Two items that lie alone on the floor change places."""
    alone = [t for t in _tops(world) if t.z == 0]
    return [
        world.changed(replace(a, cell=b.cell), replace(b, cell=a.cell))
        for i, a in enumerate(alone)
        for b in alone[i + 1 :]
    ]


def _tops(world: BurgerWorld) -> list[Thing]:
    return [t for t in world.things if t.is_item and t.name != world.held and world.cover(t.name) is None]
