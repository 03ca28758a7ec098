"""Ground STRIPS tasks on integers: fact i is bit i, a state is an int."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Strips:
    """A ground planning task with unit costs. Operator k is ``pre[k]``, ``add[k]``, ``delete[k]``.

    Applicable iff ``pre & ~state == 0``; the successor is ``state & ~delete | add``.
    """

    facts: int
    pre: tuple[int, ...]
    add: tuple[int, ...]
    delete: tuple[int, ...]
    initial: int
    goal: int

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

    def without_static_facts(self) -> Strips:
        """The same task for a heuristic: initial facts that no operator touches leave preconditions and goal."""
        touched = 0
        for add, delete in zip(self.add, self.delete, strict=True):
            touched |= add | delete
        keep = ~(self.initial & ~touched)
        pre = tuple(p & keep for p in self.pre)
        return Strips(self.facts, pre, self.add, self.delete, self.initial & keep, self.goal & keep)


def bits(mask: int) -> Iterator[int]:
    """Positions of the set bits of ``mask``, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low
