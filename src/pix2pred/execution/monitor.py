"""Which atoms the rest of a plan needs: the goal, regressed through it (method 8.5)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pix2pred.structs import AbstractState, Atom, GroundOperator


def necessary_atoms(plan: Sequence[GroundOperator], goal: Iterable[Atom]) -> list[AbstractState]:
    """For every position of ``plan`` the atoms that must hold there for the rest to succeed; the goal comes last."""
    needed = [frozenset(goal)]
    for step in reversed(plan):
        needed.append((needed[-1] - step.add) | step.preconditions)
    return needed[::-1]
