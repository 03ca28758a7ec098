"""Are learned invariants true? Checks those of a world model in random reachable states of the simulator.

    python benchmarks/invariants.py --domain burger --family combo --seed 0 --train-rate 0.02 --states 1000

The model is that of ``acting.py``, learned from the reader's labels, a share --train-rate of them flipped. States are
reached by random skills on random objects from test tasks; given atoms come from the simulator, visual ones from its
ground truth. Prints every invariant with the number of states in which it was broken, and one JSON object.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from itertools import count, islice
from pathlib import Path

import numpy as np

from acting import learned
from pix2pred.registry import REGISTRY, load_domain
from pix2pred.structs import AbstractState, Action, Atom, FromVLM, LiftedAtom, Object, WorldModel, groundings
from pix2pred.structs.environment import Domain, Environment
from pix2pred.structs.knowledge import Invariant, MutexGroup

STEPS = 12
"""Random skills after which another task is begun."""

TRIES = 20
"""Random skills tried for one that works."""


def reachable(
    domain: Domain, family: str, model: WorldModel, seed: int
) -> Iterator[tuple[Sequence[Object], AbstractState]]:
    """States and their objects; a task's simulator is walked for ``STEPS`` skills."""
    rng = np.random.default_rng(seed)
    for number in count():
        task = domain.tasks(family, 1_000 + seed + number, 1)[0]
        environment = domain.environment(task.task, task.simulator)
        environment.reset()
        objects = task.task.objects
        actions = [
            Action(skill, args, tuple(float(x) for x in (np.array(skill.low) + np.array(skill.high)) / 2))
            for skill in model.vocabulary.skills
            for args in groundings(skill.types, objects, distinct=True)
        ]
        for _ in range(STEPS):
            yield objects, state_of(domain, environment, model, objects)
            for _ in range(TRIES):
                before = environment.observe().given
                environment.execute(actions[int(rng.integers(len(actions)))])
                if environment.observe().given != before:
                    break


def state_of(domain: Domain, environment: Environment, model: WorldModel, objects: Sequence[Object]) -> AbstractState:
    """The true atoms of the model's predicates."""
    truth = REGISTRY.truth(domain, environment)
    assert truth is not None, "the domain knows the truth of its reader's words"
    held = set(environment.observe().given)
    for predicate in model.predicates:
        if isinstance(predicate.source, FromVLM):
            held |= {a for o in groundings(predicate.types, objects, distinct=True) if truth(a := Atom(predicate, o))}
    return frozenset(held)


def broken(invariant: Invariant, objects: Sequence[Object], state: AbstractState) -> bool:
    """Whether some instance does not hold in ``state``."""
    if not isinstance(invariant, MutexGroup):
        variables = invariant.premise.variables
        for chosen in groundings([v.type for v in variables], objects, distinct=True):
            binding = dict(zip(variables, chosen, strict=True))
            if invariant.premise.ground(binding) in state and invariant.conclusion.ground(binding) not in state:
                return True
        return False
    (fixed,) = invariant.fixed
    for thing in objects:
        if thing.type.is_a(fixed.type):
            held = sum(_is_about(atom, lifted, fixed, thing) for lifted in invariant.atoms for atom in state)
            if held > 1 or (invariant.exactly and held == 0):
                return True
    return False


def _is_about(atom: Atom, lifted: LiftedAtom, fixed: object, thing: Object) -> bool:
    return atom.predicate == lifted.predicate and all(
        o == thing if v == fixed else o.type.is_a(v.type) for o, v in zip(atom.objects, lifted.variables, strict=True)
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domain", default="burger")
    parser.add_argument("--family", default="combo")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--train-rate", type=float, default=0.02)
    parser.add_argument("--operators", default="robust")
    parser.add_argument("--states", type=int, default=1000)
    parser.add_argument("--out", type=Path, default=Path("runs/acting"))
    given = parser.parse_args()
    domain = load_domain(given.domain)
    model, _ = learned(domain, given.family, given.seed, given.train_rate, given.operators, given.out)
    counts = dict.fromkeys(model.invariants, 0)
    for objects, state in islice(reachable(domain, given.family, model, given.seed), given.states):
        for invariant in counts:
            counts[invariant] += broken(invariant, objects, state)
    for invariant, number in counts.items():
        print(f"{invariant} (support {invariant.support}): broken in {number} of {given.states} states")
    print(
        json.dumps({"invariants": len(counts), "refuted": sum(n > 0 for n in counts.values()), "states": given.states})
    )


if __name__ == "__main__":
    main()
