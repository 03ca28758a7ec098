"""Ground truth of visual words, for tests, for training the reader, and for naming failures once they happened."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from pix2pred.domains.home.episode import HomeEnvironment
from pix2pred.domains.home.places import in_bin, on_floor, on_table, things_in, things_on
from pix2pred.domains.home.world import World


@dataclass(frozen=True, slots=True)
class Concept:
    """What a word means here: the type names of its arguments and its value in a world."""

    types: tuple[str, ...]
    value: Callable[..., bool]


CONCEPTS: Mapping[str, Concept] = {
    "is_eraser": Concept(("movable_object",), lambda w, m: w.thing(m).kind == "eraser"),
    "on_floor": Concept(("movable_object",), on_floor),
    "held": Concept(("movable_object",), lambda w, m: w.holding == m),
    "on_table": Concept(("movable_object", "table"), on_table),
    "in_bin": Concept(("movable_object", "trash_can"), in_bin),
    "clear": Concept(("table",), lambda w, t: not things_on(w, t)),
    "wiped": Concept(("table",), lambda w, t: not w.thing(t).strokes),
    "bin_empty": Concept(("trash_can",), lambda w, c: not things_in(w, c)),
    "narrow": Concept(("trash_can",), lambda w, c: w.thing(c).kind == "narrow_bin"),
}


def concept_value(world: World, concept: str, names: Sequence[str]) -> bool:
    """The value of ``concept`` for the objects called ``names``. Raises ``ValueError`` when either does not fit."""
    if concept not in CONCEPTS:
        raise ValueError(f"no ground truth for {concept!r}; known are {', '.join(CONCEPTS)}")
    wanted = CONCEPTS[concept].types
    types = world.types()
    if len(names) != len(wanted) or any(types.get(n) != t for n, t in zip(names, wanted, strict=True)):
        raise ValueError(f"{concept} takes ({', '.join(wanted)}), found ({', '.join(names)})")
    return CONCEPTS[concept].value(world, *names)


def value_now(environment: HomeEnvironment, concept: str, names: Sequence[str]) -> bool:
    """The value of ``concept`` in the environment's present state."""
    return concept_value(environment.world, concept, names)
