"""Ground truth of visual words, for tests, for training the reader, and for naming failures once they happened."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from pix2pred.domains.home.drawing.vessels import VESSELS
from pix2pred.domains.home.episode import HomeEnvironment
from pix2pred.domains.home.places import Region, hopper_contents, in_hopper, in_region
from pix2pred.domains.home.world import World
from pix2pred.domains.juice.rules import juice_of


@dataclass(frozen=True, slots=True)
class Concept:
    """What a word means here: the type names of its arguments and its value in a world."""

    types: tuple[str, ...]
    value: Callable[..., bool]


def _outside(world: World, fruit: str) -> bool:
    return not any(in_hopper(world, fruit, j.name) for j in world.of_type("juicer"))


CONCEPTS: Mapping[str, Concept] = {
    "is_cup": Concept(("container",), lambda w, c: VESSELS[w.thing(c).kind].cup),
    "is_plastic": Concept(("container",), lambda w, c: VESSELS[w.thing(c).kind].plastic),
    "empty": Concept(("container",), lambda w, c: not w.thing(c).contents),
    "container_held": Concept(("container",), lambda w, c: w.holding == c),
    "juice_region": Concept(("container", "juicer"), lambda w, c, j: in_region(w, c, j, Region.JUICE)),
    "waste_region": Concept(("container", "juicer"), lambda w, c, j: in_region(w, c, j, Region.WASTE)),
    "outside": Concept(("movable_object",), _outside),
    "fruit_held": Concept(("movable_object",), lambda w, m: w.holding == m),
    "squeezed": Concept(("movable_object",), lambda w, m: w.thing(m).squeezed),
    "inside": Concept(("movable_object", "juicer"), in_hopper),
    "juice_in_cup": Concept(("movable_object", "container"), juice_of),
    "lid_closed": Concept(("juicer",), lambda w, j: not w.thing(j).opened),
    "functional": Concept(("juicer",), lambda w, j: w.thing(j).powered),
    "loaded": Concept(("juicer",), lambda w, j: bool(hopper_contents(w, j))),
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
