"""Selection workloads of any size from the burger simulator: typed words, synonyms, distractors, wrong labels.

A workload is a truth table with the true values of every word and the meaning of every word; ``wrong_labels`` flips and
hides labels of the candidates, the given predicates stay exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.burger.classifiers import objects_of, true_atoms
from pix2pred.domains.burger.families import BurgerFamily, bind_action, bind_atom, load_families
from pix2pred.domains.burger.scenes import initial_world
from pix2pred.domains.burger.skills import policy_for
from pix2pred.domains.burger.truth import CONCEPTS, concept_value
from pix2pred.domains.burger.vocabulary import TYPE_OF
from pix2pred.domains.burger.world import BurgerWorld, advance
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.predicates import ground_atoms
from pix2pred.structs import Atom, Candidate, FromVLM, LabelledDemo, Predicate, TruthTable

SYNONYMS = {
    "cooked": ("Cooked", "Grilled", "Done", "Browned"), "not cooked": ("Raw", "Uncooked", "Pink"),
    "chopped": ("Chopped", "Sliced", "Shredded"), "not chopped": ("Whole", "Intact"),
    "hand_empty": ("EmptyHanded", "Available", "Free"), "not hand_empty": ("Busy", "HandsFull"),
    "held": ("Held", "Carried"), "not held": ("Released",),
    "holding": ("Grasping", "Carrying"), "on": ("RestingOn", "Atop", "StackedOn"), "above": ("Above", "Over"),
    "covered": ("Covered", "Blocked"), "not covered": ("Uncovered", "TopClear"),
    "on_ground": ("OnFloor", "OnCounter"), "on_station": ("OnStation",), "occupied": ("InUse", "Occupied"),
    "not occupied": ("Empty", "Vacant"), "facing": ("Facing", "LookingAt"), "adjacent": ("Near", "NextTo"),
    "stacked": ("Stacked",), "not stacked": ("Separate",), "top_of_stack": ("TopOfStack",),
    "always": ("Visible", "Edible"), "never": ("Burnt", "Broken"), "flicker": ("Fresh", "Shiny", "Tilted"),
}  # fmt: skip
"""Words per meaning; "always" and "never" are constant but for rare labels, "flicker" is a coin thrown per label."""

NEEDED = {"more-stacks": ("cooked", "hand_empty"), "bigger": ("cooked", "hand_empty"),
          "combo": ("cooked", "hand_empty", "chopped")}  # fmt: skip
LEAVES = ("bottom_bun", "patty", "top_bun", "lettuce", "grill", "cutting_board", "robot")


@dataclass(frozen=True)
class Workload:
    """A table of true labels and what each candidate means."""

    family: str
    table: TruthTable
    meaning: Mapping[Predicate, str]

    def right(self, selected: Sequence[Predicate]) -> bool:
        """Whether the selected predicates have the needed meanings, each once, and nothing else is selected."""
        return sorted(self.meaning[p].removeprefix("not ") for p in selected) == sorted(NEEDED[self.family])


def demonstration_worlds(family: BurgerFamily, index: int, seed: int) -> list[BurgerWorld]:
    recipe = family.demonstrations[index % len(family.demonstrations)]
    generator = scene_generator(seed, Split.DEMONSTRATIONS, family.index, index)
    worlds = [initial_world(recipe.scene, generator)]
    for skill in recipe.skills:
        policy, world = policy_for(skill, worlds[-1]), worlds[-1]
        while not policy.finished(world):
            world = advance(world, policy(world))
        worlds.append(world)
    return worlds


def value_of(meaning: str, world: BurgerWorld, names: Sequence[str]) -> bool:
    """The true value of a meaning; constants have one, coins do not."""
    if meaning in ("always", "never"):
        return meaning == "always"
    if meaning == "flicker":
        return False
    return concept_value(world, meaning.removeprefix("not "), names) != meaning.startswith("not ")


@cache
def pool(present: tuple[str, ...]) -> dict[Predicate, str]:
    """Every typed word over the leaf types ``present``: ``RestingOn_patty_grill``, ``Grilled_patty``, ..."""
    words: dict[Predicate, str] = {}
    for meaning, forms in SYNONYMS.items():
        concept = CONCEPTS.get(meaning.removeprefix("not "))
        wanted = concept.types if concept else ("object",)
        domains = [[t for t in present if TYPE_OF[t].is_a(TYPE_OF[w])] for w in wanted]
        for types, form in product(product(*domains), forms):
            name = "_".join((form, *types))
            words[Predicate(name, tuple(TYPE_OF[t] for t in types), FromVLM(name))] = meaning
    return words


def workload(family_name: str, candidates: int, demos: int | None = None, seed: int = 0) -> Workload:
    """``candidates`` words, every needed meaning among them, over ``demos`` demonstrations with perfect labels.

    More words than the vocabulary has are made by numbering: ``Grilled_patty_2`` is one more synonym.
    """
    family = load_families()[family_name]
    count = len(family.demonstrations) if demos is None else demos
    histories = [demonstration_worlds(family, i, seed) for i in range(count)]
    kinds = {t for worlds in histories for t in worlds[0].types().values()}
    words = pool(tuple(t for t in LEAVES if t in kinds))
    rng = np.random.default_rng([seed, candidates])
    chosen = _choose(words, candidates, NEEDED[family_name], rng)
    table = _table(family, family_name, histories, chosen, rng)
    return Workload(family_name, table, chosen)


def _choose(
    words: Mapping[Predicate, str], candidates: int, needed: Sequence[str], rng: np.random.Generator
) -> dict[Predicate, str]:
    every = sorted(words)
    order = [every[i] for i in rng.permutation(len(every))]
    first = [next(p for p in order if words[p] == meaning) for meaning in needed]
    copies = 1 + candidates // len(every)
    rest = [p for p in order if p not in first]
    rest += [replace(p, name=f"{p.name}_{k}") for k in range(2, copies + 2) for p in order]
    return {p: words.get(p) or words[_original(p, words)] for p in [*first, *rest][:candidates]}


def _original(p: Predicate, words: Mapping[Predicate, str]) -> Predicate:
    return next(w for w in words if w.name == p.name.rpartition("_")[0])


def _table(
    family: BurgerFamily,
    name: str,
    histories: Sequence[Sequence[BurgerWorld]],
    meaning: Mapping[Predicate, str],
    rng: np.random.Generator,
) -> TruthTable:
    demos = []
    for index, worlds in enumerate(histories):
        recipe = family.demonstrations[index % len(family.demonstrations)]
        objects = objects_of(worlds[0])
        by_name = {o.name: o for o in objects}
        atoms = ground_atoms((*family.initial, *meaning), objects)
        values = np.zeros((len(worlds), len(atoms)), dtype=np.int8)
        for t, world in enumerate(worlds):
            given = true_atoms(world, family.initial)
            known: dict[tuple[str, tuple[str, ...]], bool] = {}
            for i, atom in enumerate(atoms):
                kind = meaning.get(atom.predicate)
                if kind is None:
                    values[t, i] = atom in given
                    continue
                names = tuple(o.name for o in atom.objects)
                if (kind, names) not in known:
                    known[kind, names] = value_of(kind, world, names)
                values[t, i] = known[kind, names]
        coins = [i for i, atom in enumerate(atoms) if meaning.get(atom.predicate) == "flicker"]
        values[:, coins] = rng.random((len(worlds), len(coins))) < 0.5
        actions = tuple(bind_action(a, by_name) for a in recipe.skills)
        goal = tuple(sorted(bind_atom(a, by_name, family.initial) for a in recipe.goal))
        demos.append(LabelledDemo(f"{name}-{index}", tuple(sorted(objects)), actions, goal, atoms, values))
    candidates = tuple(Candidate(p, float(p.arity)) for p in sorted(meaning))
    return TruthTable(family.initial, candidates, tuple(demos))


def wrong_labels(
    table: TruthTable, flip: float, seed: int, *, unknown: float = 0.0, sticky: bool = False
) -> TruthTable:
    """The table with labels of the candidates flipped and hidden.

    Independent errors hit every label alike. A sticky error persists until a skill has one of the atom's objects among
    its arguments; at such a moment, and in the first state, an error begins with probability ``flip``.
    """
    rng = np.random.default_rng([seed, 17])
    demos = []
    for demo in table.demos:
        values = demo.values.copy()
        columns = np.array([a.predicate not in table.initial for a in demo.atoms])
        wrong = rng.random(values.shape) < flip
        if sticky:
            _persist(wrong, demo)
        wrong &= columns
        values[wrong] = 1 - values[wrong]
        values[(rng.random(values.shape) < unknown) & columns] = -1
        demos.append(LabelledDemo(demo.name, demo.objects, demo.actions, demo.goal, demo.atoms, values))
    return TruthTable(table.initial, table.pool, tuple(demos))


def _persist(wrong: NDArray[np.bool_], demo: LabelledDemo) -> None:
    for t, action in enumerate(demo.actions):
        untouched = np.array([not set(a.objects) & set(action.objects) for a in demo.atoms])
        wrong[t + 1, untouched] = wrong[t, untouched]


def true_state(
    world: BurgerWorld, predicates: Sequence[Predicate], meaning: Mapping[Predicate, str]
) -> frozenset[Atom]:
    """The true atoms over given predicates and words in a world."""
    words = [p for p in predicates if p in meaning]
    given = true_atoms(world, tuple(p for p in predicates if p not in meaning))
    atoms = ground_atoms(words, objects_of(world))
    return frozenset(given) | {
        a for a in atoms if value_of(meaning[a.predicate], world, tuple(o.name for o in a.objects))
    }
