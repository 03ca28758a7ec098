"""Ground truth of visual words: what a domain says that a word means, and whether it holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import eq
from typing import Any


@dataclass(frozen=True, slots=True)
class Concept:
    """What a word means in a domain: the type names of its arguments and its value in a world."""

    types: tuple[str, ...]
    value: Callable[..., bool]


@dataclass(frozen=True, slots=True)
class TrueWords:
    """Every word of a domain that has a ground truth.

    ``types`` gives the type name of every object of a world; ``is_a`` tells whether a type, by its name, may stand
    where another is wanted.
    """

    concepts: Mapping[str, Concept]
    types: Callable[[Any], Mapping[str, str]]
    is_a: Callable[[str, str], bool] = eq

    def value(self, world: Any, concept: str, names: Sequence[str]) -> bool:
        """The value of ``concept`` for the objects called ``names``. Raises ``ValueError`` when either does not fit."""
        if concept not in self.concepts:
            raise ValueError(f"no ground truth for {concept!r}; known are {', '.join(self.concepts)}")
        meant, types = self.concepts[concept], self.types(world)
        fits = len(names) == len(meant.types) and all(
            n in types and self.is_a(types[n], t) for n, t in zip(names, meant.types, strict=True)
        )
        if not fits:
            raise ValueError(f"{concept} takes ({', '.join(meant.types)}), found ({', '.join(names)})")
        return meant.value(world, *names)
