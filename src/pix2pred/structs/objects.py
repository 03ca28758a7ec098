"""Types, objects and variables (method 1.1)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product

_UNSPEAKABLE = re.compile(r"[^A-Za-z0-9]+")


@dataclass(frozen=True, slots=True)
class Type:
    """A kind of object: a name, the names of its numeric features, and an optional parent.

    Features are not inherited: every type lists its own. ``description`` says in a sentence what belongs to the type,
    for people and for models that are asked; ``measures`` says what the features of the type and its kinds are, with
    their units.
    """

    name: str
    features: tuple[str, ...] = ()
    parent: Type | None = None
    description: str = field(default="", compare=False)
    measures: str = field(default="", compare=False)

    def __hash__(self) -> int:
        """By name: atoms are hashed all the time, and two things that differ in nothing but the rest are rare."""
        return hash(self.name)

    @property
    def lineage(self) -> Iterator[Type]:
        """This type and those above it, the most general last."""
        node: Type | None = self
        while node is not None:
            yield node
            node = node.parent

    def is_a(self, other: Type) -> bool:
        """Whether this type is ``other`` or has it among its ancestors."""
        node: Type | None = self
        while node is not None:  # asked too often to go through ``lineage``
            if node.name == other.name:
                return True
            node = node.parent
        return False

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class Object:
    """A named thing in a scene. ``descriptor`` is the phrase that picks it out in the pictures."""

    name: str
    type: Type
    descriptor: str = ""

    def __hash__(self) -> int:
        return hash(self.name)

    @property
    def prompt_name(self) -> str:
        """What prompts call it: the descriptor, or else the name, as one word of letters, digits and ``_``."""
        return _prompt_name(self.descriptor, self.name)

    def __lt__(self, other: Object) -> bool:
        return (self.name, self.type.name, self.descriptor) < (other.name, other.type.name, other.descriptor)

    def __str__(self) -> str:
        return self.name


@lru_cache(maxsize=1024)
def _prompt_name(descriptor: str, name: str) -> str:
    return _UNSPEAKABLE.sub("_", descriptor).strip("_") or name.replace("-", "_")


@dataclass(frozen=True, slots=True)
class Variable:
    """A typed placeholder for an object, e.g. ``?x0`` of type ``patty``."""

    name: str
    type: Type

    def __lt__(self, other: Variable) -> bool:
        return (self.name, self.type.name) < (other.name, other.type.name)

    def __str__(self) -> str:
        return self.name


def groundings(types: Sequence[Type], objects: Iterable[Object], *, distinct: bool) -> Iterator[tuple[Object, ...]]:
    """Every tuple of objects whose types match ``types``, in sorted order.

    ``distinct`` leaves out tuples that name one object twice (method 1.5, switch ``distinct_args``).
    """
    ordered = sorted(objects)
    for candidate in product(*([o for o in ordered if o.type.is_a(t)] for t in types)):
        if not distinct or len(set(candidate)) == len(candidate):
            yield candidate


def count_groundings(types: Sequence[Type], objects: Iterable[Object], *, distinct: bool) -> int:
    """How many tuples ``groundings`` gives, without making them."""
    listed = list(objects)
    pools = sorted((frozenset(o for o in listed if o.type.is_a(t)) for t in types), key=len)
    total = 1
    for i, pool in enumerate(pools):  # types form a tree: two pools are one inside the other, or disjoint
        total *= max(0, len(pool) - (sum(p <= pool for p in pools[:i]) if distinct else 0))
    return total
