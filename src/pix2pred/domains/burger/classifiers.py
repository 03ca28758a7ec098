"""The exact truth of the given predicates (method 10.2). Composite predicates take the support first."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial

from pix2pred.domains.burger.vocabulary import make_object, printed_name
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.domains.given import holding
from pix2pred.structs import Atom, Object, Predicate


def _somewhere_above(world: BurgerWorld, support: str, item: str) -> bool:
    low, high = world.thing(support), world.thing(item)
    return low.cell == high.cell and low.z < high.z and high.prepared


def _right_above(world: BurgerWorld, support: str, item: str) -> bool:
    low, high = world.thing(support), world.thing(item)
    return low.cell == high.cell and low.z == high.z - 1 and high.prepared


_CLASSIFIERS: Mapping[str, Callable[..., bool]] = {
    "On": lambda w, item, support: w.supports(support, item),
    "OnGround": lambda w, item: w.thing(item).z == 0,
    "Clear": lambda w, name: name != w.held and w.cover(name) is None,
    "Holding": lambda w, robot, item: robot == w.robot and w.held == item,
    "SomewhereAboveAndPrepped": _somewhere_above,
    "RightAboveAndPrepped": _right_above,
}


def holds(world: BurgerWorld, atom: Atom) -> bool:
    """Whether a given atom is true. Raises ``ValueError`` for a predicate of another domain."""
    name = printed_name(atom.predicate.name)
    if name not in _CLASSIFIERS:
        raise ValueError(f"{atom.predicate.name} is not a given predicate of the burger domain")
    return _CLASSIFIERS[name](world, *(o.name for o in atom.objects))


def objects_of(world: BurgerWorld) -> tuple[Object, ...]:
    """All objects of ``world``, sorted."""
    return tuple(sorted(make_object(name, kind) for name, kind in world.types().items()))


def true_atoms(world: BurgerWorld, predicates: Iterable[Predicate]) -> frozenset[Atom]:
    """The atoms that hold, over all type-consistent groundings with distinct objects."""
    return holding(predicates, objects_of(world), partial(holds, world))
