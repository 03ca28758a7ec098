"""Opposites of predicates: with them a goal says what must not hold.

That ``On(a, b)`` must not hold is written ``not On(a, b)`` and is an atom of a predicate of its own, the opposite: it
is true where the other is not, and operators that add the one delete the other. So all that works on atoms works on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from pix2pred.structs.objects import Object, groundings
from pix2pred.structs.operators import GroundOperator, Operator
from pix2pred.structs.predicates import Atom, FromOpposite, LiftedAtom, Predicate
from pix2pred.structs.states import AbstractState


def opposite(predicate: Predicate) -> Predicate:
    """The predicate that is true where ``predicate`` is not; of an opposite, the predicate itself."""
    if isinstance(predicate.source, FromOpposite):
        return predicate.source.of
    return Predicate(f"not {predicate.name}", predicate.types, FromOpposite(predicate))


def contrary(atom: Atom) -> Atom:
    """The atom that holds exactly where ``atom`` does not."""
    return Atom(opposite(atom.predicate), atom.objects)


def affirmed(atom: Atom) -> Atom:
    """What ``atom`` is about: the atom that must not hold, where it says that one must not, else itself."""
    return contrary(atom) if is_denial(atom) else atom


def is_denial(atom: Atom | LiftedAtom) -> bool:
    """Whether ``atom`` says that something does not hold."""
    return isinstance(atom.predicate.source, FromOpposite)


def denied_in(goal: Iterable[Atom]) -> frozenset[Predicate]:
    """The predicates of which ``goal`` says that an atom must not hold."""
    return frozenset(a.predicate.source.of for a in goal if isinstance(a.predicate.source, FromOpposite))


def holds(goal: Iterable[Atom], state: AbstractState) -> bool:
    """Whether ``goal`` holds in ``state``, which lists no opposites."""
    return all(contrary(a) not in state if is_denial(a) else a in state for a in goal)


def with_denials(state: AbstractState, denied: Iterable[Predicate], objects: Iterable[Object]) -> AbstractState:
    """``state`` with the opposites of all atoms of the predicates ``denied`` over ``objects`` that do not hold."""
    there = list(objects)
    found = set(state)
    for predicate in denied:
        for chosen in groundings(list(predicate.types), there, distinct=False):
            if Atom(predicate, tuple(chosen)) not in state:
                found.add(Atom(opposite(predicate), tuple(chosen)))
    return frozenset(found)


def changing_denials(operators: Sequence[Operator], denied: frozenset[Predicate]) -> tuple[Operator, ...]:
    """``operators`` that keep the opposites of the predicates ``denied`` up to date as well."""
    if not denied:
        return tuple(operators)

    def contraries(atoms: frozenset[LiftedAtom]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(opposite(a.predicate), a.variables) for a in atoms if a.predicate in denied)

    return tuple(
        replace(o, add=o.add | contraries(o.delete - o.add), delete=o.delete | contraries(o.add)) for o in operators
    )


def as_learned(step: GroundOperator, operators: Iterable[Operator]) -> GroundOperator:
    """``step`` of the operator among ``operators`` that is called like its own."""
    return next(o for o in operators if o.name == step.operator.name).ground(step.objects)
