"""The given predicates and when they hold (method 10.3)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from enum import Enum

from pix2pred.domains.coffee.simulation.motion import cup_below, pressing
from pix2pred.domains.coffee.skills import handle_reachable
from pix2pred.domains.coffee.vocabulary import make_object
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.domains.given import holding
from pix2pred.structs import Atom, Object, Predicate


class AboveCup(Enum):
    """When a held jug, and the robot with it, counts as above a cup.

    ``ANYWHERE`` is the published behaviour: the tolerance, a squared distance of 1, is larger than the table, so that a
    held jug is above every cup. ``NEAR`` asks for the spout to be over the cup, and gives other operators.
    """

    ANYWHERE = "anywhere"
    NEAR = "near"


_TOLERANCE = 1.0
"""Squared distance, in metres, between spout and mouth that still counts (the published value)."""


def _above(world: CoffeeWorld, cup: str, above: AboveCup) -> bool:
    if not world.jug.held:
        return False
    if above is AboveCup.NEAR:
        below = cup_below(world)
        return below is not None and below.name == cup
    return math.dist(tuple(world.spout), tuple(world.cup(cup).mouth)) ** 2 < _TOLERANCE


_CLASSIFIERS: Mapping[str, Callable[[CoffeeWorld, AboveCup, tuple[str, ...]], bool]] = {
    "CupFilled": lambda w, above, args: w.cup(args[0]).filled,
    "Holding": lambda w, above, args: w.jug.held,
    "OnTable": lambda w, above, args: not w.jug.held and not w.jug_in_machine,
    "HandEmpty": lambda w, above, args: not w.jug.held,
    "RobotAboveCup": lambda w, above, args: _above(w, args[1], above),
    "JugAboveCup": lambda w, above, args: _above(w, args[1], above),
    "NotAboveCup": lambda w, above, args: not any(_above(w, cup.name, above) for cup in w.cups),
    "PressingButton": lambda w, above, args: pressing(w),
    "NotSameCup": lambda w, above, args: args[0] != args[1],
    "JugPickable": lambda w, above, args: handle_reachable(w),
}


def holds(world: CoffeeWorld, atom: Atom, above: AboveCup) -> bool:
    """Whether a given atom is true. Raises ``ValueError`` for a predicate of another domain."""
    if atom.predicate.name not in _CLASSIFIERS:
        raise ValueError(f"{atom.predicate.name} is not a given predicate of the coffee domain")
    return _CLASSIFIERS[atom.predicate.name](world, above, tuple(o.name for o in atom.objects))


def objects_of(world: CoffeeWorld) -> tuple[Object, ...]:
    """All objects of ``world``, sorted."""
    return tuple(sorted(make_object(name, kind) for name, kind in world.types().items()))


def true_atoms(world: CoffeeWorld, predicates: Iterable[Predicate], above: AboveCup) -> frozenset[Atom]:
    """The atoms that hold, over all type-consistent groundings with distinct objects."""
    return holding(predicates, objects_of(world), lambda atom: holds(world, atom, above))
