"""Perfect symbols for the burger families, straight from the simulator's worlds, without drawing a picture."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pix2pred.domains.burger.classifiers import objects_of, true_atoms
from pix2pred.domains.burger.families import bind_action, bind_atom, load_families
from pix2pred.domains.burger.scenes import initial_world
from pix2pred.domains.burger.skills import policy_for
from pix2pred.domains.burger.truth import CONCEPTS, concept_value
from pix2pred.domains.burger.vocabulary import TYPE_OF
from pix2pred.domains.burger.world import BurgerWorld, advance
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.predicates import ground_atoms
from pix2pred.structs import Application, Candidate, FromVLM, LabelledDemo, Predicate, TruthTable


def run_skill(world: BurgerWorld, skill: Application) -> BurgerWorld:
    policy = policy_for(skill, world)
    while not policy.finished(world):
        world = advance(world, policy(world))
    return world


def visual(name: str, concept: str) -> Predicate:
    return Predicate(name, tuple(TYPE_OF[t] for t in CONCEPTS[concept].types), FromVLM(name))


def true_table(family_name: str, words: Mapping[str, str], seed: int = 0) -> TruthTable:
    """The demonstrations of a family with every word (name -> concept) labelled perfectly."""
    family = load_families()[family_name]
    predicates = {visual(name, concept): concept for name, concept in words.items()}
    demos = []
    for index, recipe in enumerate(family.demonstrations):
        world = initial_world(recipe.scene, scene_generator(seed, Split.DEMONSTRATIONS, family.index, index))
        worlds = [world]
        for skill in recipe.skills:
            worlds.append(run_skill(worlds[-1], skill))
        objects = objects_of(world)
        by_name = {o.name: o for o in objects}
        atoms = ground_atoms((*family.initial, *predicates), objects)
        values = np.zeros((len(worlds), len(atoms)), dtype=np.int8)
        for t, w in enumerate(worlds):
            given = true_atoms(w, family.initial)
            for i, atom in enumerate(atoms):
                concept = predicates.get(atom.predicate)
                names = [o.name for o in atom.objects]
                values[t, i] = atom in given if concept is None else concept_value(w, concept, names)
        actions = tuple(bind_action(a, by_name) for a in recipe.skills)
        goal = tuple(sorted(bind_atom(a, by_name, family.initial) for a in recipe.goal))
        demos.append(LabelledDemo(f"{family_name}-{index}", tuple(sorted(objects)), actions, goal, atoms, values))
    return TruthTable(family.initial, tuple(Candidate(p, float(p.arity)) for p in sorted(predicates)), tuple(demos))
