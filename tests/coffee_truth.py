"""Perfect symbols for the coffee demonstrations, straight from the simulator's worlds, without drawing a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pix2pred.domains.coffee.classifiers import AboveCup, objects_of, true_atoms
from pix2pred.domains.coffee.demonstrator import actions_of, all_filled
from pix2pred.domains.coffee.environment import CoffeeEnvironment
from pix2pred.domains.coffee.families import DEMONSTRATIONS, CoffeeRecipe
from pix2pred.domains.coffee.scenes import initial_world
from pix2pred.domains.coffee.truth import CONCEPTS, concept_value
from pix2pred.domains.coffee.vocabulary import GIVEN, TYPE_OF
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.predicates import ground_atoms
from pix2pred.structs import Candidate, FromVLM, LabelledDemo, Predicate, TruthTable
from pix2pred.structs.environment import StepStatus


def visual(name: str, concept: str) -> Predicate:
    return Predicate(name, tuple(TYPE_OF[t] for t in CONCEPTS[concept].types), FromVLM(name))


def run(recipe: CoffeeRecipe, world: CoffeeWorld) -> list[CoffeeWorld]:
    """The worlds before, between and after the skills of ``recipe``."""
    environment = CoffeeEnvironment(world, GIVEN, (), AboveCup.ANYWHERE)
    worlds = [world]
    for action in actions_of(recipe, world):
        step = environment.execute(action)
        assert step.status is StepStatus.DONE, step.detail
        worlds.append(environment.world)
    return worlds


def true_table(
    words: Mapping[str, str],
    seed: int = 0,
    above: AboveCup = AboveCup.ANYWHERE,
    recipes: Sequence[CoffeeRecipe] = DEMONSTRATIONS,
) -> TruthTable:
    """The demonstrations with every word (name -> concept) labelled perfectly."""
    predicates = {visual(name, concept): concept for name, concept in words.items()}
    demos = []
    for index, recipe in enumerate(recipes):
        start = initial_world(recipe.cups, scene_generator(seed, Split.DEMONSTRATIONS, 0, index), recipe.turned_away)
        worlds = run(recipe, start)
        objects = objects_of(start)
        atoms = ground_atoms((*GIVEN, *predicates), objects)
        values = np.zeros((len(worlds), len(atoms)), dtype=np.int8)
        for t, world in enumerate(worlds):
            given = true_atoms(world, GIVEN, above)
            for i, atom in enumerate(atoms):
                concept = predicates.get(atom.predicate)
                names = [o.name for o in atom.objects]
                values[t, i] = atom in given if concept is None else concept_value(world, concept, names)
        goal = tuple(sorted(all_filled(objects)))
        demos.append(LabelledDemo(f"coffee-{index}", objects, actions_of(recipe, start), goal, atoms, values))
    return TruthTable(GIVEN, tuple(Candidate(p, float(p.arity)) for p in sorted(predicates)), tuple(demos))
