"""Lifted invariants: what holds in every state that can be reached (Helmert 2009, section 5)."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.structs.objects import Variable
from pix2pred.structs.predicates import LiftedAtom


@dataclass(frozen=True, slots=True)
class MutexGroup:
    """For every binding of ``fixed``, at most one atom of the group holds; with ``exactly``, one always does.

    Variables of ``atoms`` that are not in ``fixed`` are counted: they range over all objects of their type. ``support``
    is the number of instances in the demonstrations' states in which an atom of the group holds.
    """

    fixed: tuple[Variable, ...]
    atoms: frozenset[LiftedAtom]
    exactly: bool
    support: int

    def __str__(self) -> str:
        listed = ", ".join(_with_stars(a, self.fixed) for a in sorted(self.atoms))
        return f"{'exactly' if self.exactly else 'at most'} one of {listed}"


@dataclass(frozen=True, slots=True)
class Implication:
    """Whenever ``premise`` holds, ``conclusion`` holds; its variables are among those of ``premise``.

    ``support`` is the number of instances in the demonstrations' states in which ``premise`` holds.
    """

    premise: LiftedAtom
    conclusion: LiftedAtom
    support: int

    def __str__(self) -> str:
        return f"{self.premise} implies {self.conclusion}"


Invariant = MutexGroup | Implication


def _with_stars(atom: LiftedAtom, fixed: tuple[Variable, ...]) -> str:
    """The atom as text, with a star in place of every variable that is counted."""
    names = ", ".join(f"{v.name if v in fixed else '*'}:{v.type.name}" for v in atom.variables)
    return f"{atom.predicate.name}({names})"
