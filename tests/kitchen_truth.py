"""Perfect symbols for the kitchen's demonstrations, straight from the physics, without drawing a picture."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pix2pred.domains.kitchen.classifiers import true_atoms
from pix2pred.domains.kitchen.environment import KitchenEnvironment
from pix2pred.domains.kitchen.scenes import LEFT, boiling, push_kettle, start_world, turn_on
from pix2pred.domains.kitchen.truth import CONCEPTS, value_now
from pix2pred.domains.kitchen.vocabulary import INITIAL, OBJECTS, TYPES
from pix2pred.domains.seeds import Split
from pix2pred.predicates import ground_atoms
from pix2pred.structs import Atom, Candidate, Demo, FromVLM, LabelledDemo, Predicate, State, TruthTable


def visual(name: str, concept: str) -> Predicate:
    types = {t.name: t for t in TYPES}
    return Predicate(name, tuple(types[t] for t in CONCEPTS[concept].types), FromVLM(name))


def true_table(words: Mapping[str, str], seed: int = 0) -> tuple[TruthTable, tuple[Demo, ...]]:
    """The demonstrations with every word (name -> concept) labelled perfectly, and with features but no pictures."""
    predicates = {visual(name, concept): concept for name, concept in words.items()}
    atoms = tuple(ground_atoms((*INITIAL, *predicates), OBJECTS))
    labelled, demos = [], []
    for index in range(3):
        environment = KitchenEnvironment(start_world(seed, Split.DEMONSTRATIONS, index, LEFT), boiling("4"))
        actions = (turn_on("4"), push_kettle("4"))
        rows, states = [], []
        for action in (None, *actions):
            if action is not None:
                environment.execute(action)
            given = true_atoms(environment.data)
            states.append(State((), environment.features(), given))
            rows.append([_value(environment, predicates, atom, given) for atom in atoms])
        values = np.array(rows, dtype=np.int8)
        name, goal = f"boil-{index}", boiling("4")
        labelled.append(LabelledDemo(name, OBJECTS, actions, goal, atoms, values))
        demos.append(Demo(name, OBJECTS, tuple(states), actions, goal))
    pool = tuple(Candidate(p, float(p.arity)) for p in sorted(predicates))
    return TruthTable(INITIAL, pool, tuple(labelled)), tuple(demos)


def _value(
    environment: KitchenEnvironment, predicates: Mapping[Predicate, str], atom: Atom, given: frozenset[Atom]
) -> bool:
    concept = predicates.get(atom.predicate)
    return atom in given if concept is None else value_now(environment, concept, [o.name for o in atom.objects])
