"""Are learned invariants true? Checks those of a world model in random reachable states of the simulator.

    python benchmarks/invariants.py --domain burger --family combo --seed 0 --labels perfect --states 1000
    python benchmarks/invariants.py --domain burger --family combo --seed 0 --labels flipped --states 1000

``perfect``: the model is learned from labels that the simulator corrected (words without a truth keep the reader's).
``flipped``: it is that of ``acting.py``, learned from the reader's labels, a share --train-rate of them turned round.
States are reached from test tasks by skills that are random, or random among those that the model
takes for possible, in equal shares; a walk goes on after skills that fail half-way. All atoms are read from the
simulator. Prints every invariant with the number of states in which it was broken, and one JSON object. --out keeps the
models, and a line per run in OUT/invariants.jsonl.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import count, islice
from pathlib import Path
from typing import Any

import numpy as np

from acting import learned
from perfect_labels import learned_from_truth
from pix2pred.domains.burger.classifiers import true_atoms as burger_atoms
from pix2pred.domains.coffee.classifiers import AboveCup
from pix2pred.domains.coffee.classifiers import true_atoms as coffee_atoms
from pix2pred.domains.coffee.vocabulary import GIVEN
from pix2pred.domains.kitchen.classifiers import true_atoms as kitchen_atoms
from pix2pred.registry import REGISTRY, load_domain
from pix2pred.structs import (
    AbstractState,
    Action,
    Atom,
    FromVLM,
    LiftedAtom,
    Object,
    Predicate,
    Variable,
    WorldModel,
    groundings,
)
from pix2pred.structs.environment import Domain, Environment, StepStatus
from pix2pred.structs.knowledge import Invariant, MutexGroup

STEPS = 20
"""Skills after which another task is begun."""

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
        for _ in range(STEPS):
            state = state_of(domain, environment, model, objects)
            yield objects, state
            if not moved(environment, possible(model, objects, state, bool(rng.random() < 0.5)), rng):
                break


def possible(model: WorldModel, objects: Sequence[Object], state: AbstractState, learned_only: bool) -> list[Action]:
    """All skills on ``objects``, or those that the model takes for possible in ``state``."""
    found: dict[Action, None] = {}
    if learned_only:
        for operator in model.operators:
            conditions = sorted(operator.preconditions, key=lambda a: (-a.predicate.arity, a))
            for binding in bindings(conditions, {}, state):
                for bound in operator.groundings(binding, objects):
                    found[Action(operator.skill, bound.skill_objects)] = None
    if not found:
        for skill in model.vocabulary.skills:
            found |= dict.fromkeys(Action(skill, a) for a in groundings(skill.types, objects, distinct=True))
    return list(found)


def bindings(
    conditions: Sequence[LiftedAtom], binding: Mapping[Variable, Object], state: AbstractState
) -> Iterator[Mapping[Variable, Object]]:
    """The ways to bind variables, beyond ``binding``, so that all ``conditions`` hold in ``state``."""
    if not conditions:
        yield binding
        return
    first, *others = conditions
    for atom in sorted(a for a in state if a.predicate == first.predicate):
        bound = dict(zip(first.variables, atom.objects, strict=True))
        more = {**binding, **bound}
        if more == {**bound, **binding} and len(set(more.values())) == len(more):
            yield from bindings(others, more, state)


def moved(environment: Environment, chosen: Sequence[Action], rng: np.random.Generator) -> bool:
    """Whether the walk can go on after random skills with random parameters were tried until one worked."""
    for _ in range(TRIES):
        one = chosen[int(rng.integers(len(chosen)))]
        drawn = tuple(float(x) for x in rng.uniform(one.skill.low, one.skill.high)) if one.skill.low else ()
        status = environment.execute(Action(one.skill, one.objects, drawn)).status
        if status is not StepStatus.STUCK:
            return status is StepStatus.DONE
    return True


def given_atoms(domain: Any, environment: Any, given: Sequence[Predicate]) -> AbstractState:
    """The given atoms that hold, asked of the simulator itself: pictures take nine tenths of the time of a look."""
    match domain.name:
        case "burger":
            return burger_atoms(environment.world, given)
        case "coffee":
            return coffee_atoms(environment.world, GIVEN, AboveCup.ANYWHERE)
        case "kitchen":
            return kitchen_atoms(environment.data)
        case _:
            return frozenset(domain.rules.told(environment.world))


def state_of(domain: Domain, environment: Environment, model: WorldModel, objects: Sequence[Object]) -> AbstractState:
    """The true atoms of the model's predicates."""
    truth = REGISTRY.truth(domain, environment)
    assert truth is not None, "the domain knows the truth of its reader's words"
    held = {*given_atoms(domain, environment, model.vocabulary.initial)}
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
    parser.add_argument("--labels", choices=("perfect", "flipped"), default="flipped")
    parser.add_argument("--train-rate", type=float, default=0.02)
    parser.add_argument("--operators", default="robust")
    parser.add_argument("--states", type=int, default=1000)
    parser.add_argument("--out", type=Path, default=Path("runs/acting"))
    given = parser.parse_args()
    domain = load_domain(given.domain)
    if given.labels == "perfect":
        model = learned_from_truth(domain, given.family, given.seed, 0.0, given.operators, given.out)
    else:
        model, _ = learned(domain, given.family, given.seed, given.train_rate, given.operators, given.out)
    counts, met = dict.fromkeys(model.invariants, 0), set[AbstractState]()
    walked = given.states if counts else 0
    for objects, state in islice(reachable(domain, given.family, model, given.seed), walked):
        met.add(state)
        for invariant in counts:
            counts[invariant] += broken(invariant, objects, state)
    for invariant, number in counts.items():
        print(f"{invariant} (support {invariant.support}): broken in {number} of {walked} states")
    result = {
        "domain": given.domain, "family": given.family, "seed": given.seed, "labels": given.labels,
        "invariants": len(counts), "refuted": sum(n > 0 for n in counts.values()), "states": walked,
        "different": len(met), "broken": {str(i): n for i, n in counts.items() if n},
    }  # fmt: skip
    with (given.out / "invariants.jsonl").open("a") as stream:
        stream.write(json.dumps(result) + "\n")
    print(json.dumps(result))


if __name__ == "__main__":
    main()
