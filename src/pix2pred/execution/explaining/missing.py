"""Why there is no plan: which goal atoms cannot be reached even when nothing is ever deleted, and for want of what."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice

from pix2pred.planning import GroundingBudgetError, ground
from pix2pred.structs import AbstractState, Atom, GroundOperator, Object, Operator

MOST_BINDINGS = 5_000
"""Ways to fill an operator's parameters that are looked at for one atom."""

MOST_LINKS = 40
"""Atoms that an explanation names; longer chains of missing atoms help nobody."""


@dataclass(frozen=True, slots=True)
class Missing:
    """An atom that cannot be reached; ``step`` comes closest to making it true, but ``lacks`` some preconditions.

    Without a ``step`` no learned operator can make the atom true for these objects: it would have to be seen.
    """

    atom: Atom
    step: GroundOperator | None
    lacks: tuple[Atom, ...]


def missing(
    operators: Sequence[Operator], objects: Sequence[Object], seen: AbstractState, goal: Iterable[Atom]
) -> tuple[Missing, ...]:
    """The unreachable atoms of ``goal``, each followed by what it lacks in turn; every atom occurs once.

    Empty when each goal atom can be reached for itself: then they exclude one another, or deletes stand in the way.
    Empty too when the task is too large to ground.
    """
    try:
        task = ground(operators, objects, seen, tuple(goal))
    except GroundingBudgetError:
        return ()
    reachable = set(seen)
    for operator, bound in task.instances:
        reachable |= operator.ground(bound).add
    queue = [atom for atom in sorted(goal) if atom not in reachable]
    found: dict[Atom, Missing] = {}
    while queue and len(found) < MOST_LINKS:
        atom = queue.pop(0)
        if atom not in found:
            found[atom] = _closest(atom, operators, objects, reachable)
            queue = [*found[atom].lacks, *queue]
    return tuple(found.values())


def _closest(atom: Atom, operators: Sequence[Operator], objects: Sequence[Object], reachable: set[Atom]) -> Missing:
    best: tuple[int, GroundOperator] | None = None
    for operator in operators:
        for lifted in sorted(operator.add):
            if lifted.predicate == atom.predicate:
                fixed = dict(zip(lifted.variables, atom.objects, strict=True))
                for step in islice(operator.groundings(fixed, objects), MOST_BINDINGS):
                    lacking = len(step.preconditions - reachable)
                    if best is None or lacking < best[0]:
                        best = (lacking, step)
    if best is None:
        return Missing(atom, None, ())
    return Missing(atom, best[1], tuple(sorted(best[1].preconditions - reachable)))
