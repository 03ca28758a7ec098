"""Changes of single atoms between two abstract states."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from pix2pred.structs.operators import GroundOperator
from pix2pred.structs.predicates import Atom
from pix2pred.structs.states import AbstractState


@dataclass(frozen=True, slots=True)
class Change:
    """An atom that became true (``holds``) or false; written with a sign, as ``+On(a,b)``."""

    atom: Atom
    holds: bool

    def __str__(self) -> str:
        return f"{'+' if self.holds else '-'}{self.atom}"


def changes(added: Iterable[Atom], deleted: Iterable[Atom]) -> tuple[Change, ...]:
    """The changes that make ``added`` true and ``deleted`` false: those that add first, each group sorted by atom."""
    return (*(Change(a, True) for a in sorted(added)), *(Change(a, False) for a in sorted(deleted)))


def changes_between(before: AbstractState, after: AbstractState) -> tuple[Change, ...]:
    """What differs between two states."""
    return changes(after - before, before - after)


def effects(step: GroundOperator) -> tuple[Change, ...]:
    """What a step is expected to change."""
    return changes(step.add, step.delete)


def signed(found: Iterable[Change]) -> tuple[str, ...]:
    """The changes as text, for files and people."""
    return tuple(str(change) for change in found)
