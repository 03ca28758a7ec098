"""What a plan rests on: for every precondition the step that makes it true, or the look at the initial state.

These are the causal links of partial-order planning (McAllester and Rosenblitt, "Systematic nonlinear planning", 1991).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pix2pred.structs import Atom, GroundOperator


@dataclass(frozen=True, slots=True)
class Need:
    """An atom that has to hold, and the step (from 0) that last made it true; None: it has held from the start."""

    atom: Atom
    by: int | None


def needs(plan: Sequence[GroundOperator], goal: Iterable[Atom]) -> tuple[tuple[Need, ...], ...]:
    """What every step of ``plan`` needs, and last what the goal needs, each sorted by atom."""
    makers: dict[Atom, int] = {}
    found = []
    for i, step in enumerate(plan):
        found.append(_needs(step.preconditions, makers))
        for atom in step.delete:
            makers.pop(atom, None)
        makers |= dict.fromkeys(step.add, i)
    return (*found, _needs(goal, makers))


def initial_needs(plan: Sequence[GroundOperator], goal: Iterable[Atom]) -> frozenset[Atom]:
    """The atoms of the initial state that the plan and the goal need."""
    return frozenset(n.atom for step in needs(plan, goal) for n in step if n.by is None)


def _needs(atoms: Iterable[Atom], makers: dict[Atom, int]) -> tuple[Need, ...]:
    return tuple(Need(a, makers.get(a)) for a in sorted(atoms))
