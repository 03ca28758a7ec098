"""Checking a plan, independently of how it was found."""

from __future__ import annotations

from collections.abc import Iterable

from pix2pred.structs import AbstractState, Atom, GroundOperator


def is_valid(plan: Iterable[GroundOperator], initial: AbstractState, goal: Iterable[Atom]) -> bool:
    """Whether every step is applicable when its turn comes and the goal holds at the end.

    Works on sets of atoms, not on the bits the searches use.
    """
    state = initial
    for step in plan:
        if not step.applicable(state):
            return False
        state = step.apply(state)
    return frozenset(goal) <= state
