"""Ground STRIPS tasks on integers: fact i is bit i, a state is an int."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field, replace

Relaxed = tuple[int, int, int]
"""(preconditions, what is added besides them, operator): a way to make facts true when nothing is ever deleted."""


@dataclass(frozen=True, slots=True)
class Strips:
    """A ground planning task. Operator k is ``pre[k]``, ``add[k]``, ``delete[k]``, and costs ``costs[k]``.

    Applicable iff ``pre & ~state == 0``; the successor is ``state & ~delete | add``. Without ``costs`` every operator
    costs one. ``atoms`` may tell what the facts are about, each a number of a predicate followed by numbers of objects,
    and ``kinds`` of which kind every object is: so interchangeable objects are found. Equality is that of the bits.
    """

    facts: int
    pre: tuple[int, ...]
    add: tuple[int, ...]
    delete: tuple[int, ...]
    initial: int
    goal: int
    costs: tuple[int, ...] = ()
    atoms: tuple[tuple[int, ...], ...] = field(default=(), compare=False)
    kinds: tuple[Hashable, ...] = field(default=(), compare=False)

    def applicable(self, state: int) -> Iterator[int]:
        """Numbers of the operators applicable in ``state``, ascending."""
        missing = ~state
        for k, pre in enumerate(self.pre):
            if not pre & missing:
                yield k

    def successor(self, state: int, k: int) -> int:
        """The state after operator ``k``."""
        return state & ~self.delete[k] | self.add[k]

    def is_goal(self, state: int) -> bool:
        """Whether the goal holds in ``state``."""
        return not self.goal & ~state

    def cost(self, k: int) -> int:
        """What operator ``k`` costs."""
        return self.costs[k] if self.costs else 1

    def relaxed(self) -> list[Relaxed]:
        """How facts become true when nothing is ever deleted.

        An operator number beyond the operators' stands for something that happens by itself and costs nothing.
        """
        return [(pre, add & ~pre, k) for k, (pre, add) in enumerate(zip(self.pre, self.add, strict=True)) if add & ~pre]

    def touched(self) -> int:
        """The facts that some operator adds or deletes."""
        touched = 0
        for add, delete in zip(self.add, self.delete, strict=True):
            touched |= add | delete
        return touched

    def without_static_facts(self) -> Strips:
        """The same task for a heuristic: initial facts that no operator touches leave preconditions and goal."""
        keep = ~(self.initial & ~self.touched())
        return replace(self, pre=tuple(p & keep for p in self.pre), initial=self.initial & keep, goal=self.goal & keep)


def bits(mask: int) -> Iterator[int]:
    """Positions of the set bits of ``mask``, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low
