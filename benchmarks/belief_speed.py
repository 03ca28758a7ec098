"""What a belief costs: milliseconds of CPU time per look, by the number of atoms it is about.

    python benchmarks/belief_speed.py --family combo --copies 1 10 40

The model is that of ``acting.py`` (kept in --out), with so many copies of its selected predicates and of its
invariants; operators are about the first copy. Labels of a random state are told, one in twenty of them
wrong, and a learned skill is said to have been tried before every look. Asking is no part of it. The last line has the
milliseconds per look of 200 atoms, by linear interpolation.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from acting import learned
from pix2pred.execution.belief.belief import Belief, Reading
from pix2pred.registry import load_domain
from pix2pred.structs import FromVLM, GroundOperator, LiftedAtom, Object, Operator, Predicate, WorldModel
from pix2pred.structs.environment import StepStatus
from pix2pred.structs.knowledge import Invariant, MutexGroup

LOOKS = 100


def per_look(model: WorldModel, objects: list[Object], seed: int) -> tuple[int, float]:
    """The number of visual atoms, and the milliseconds that a look takes."""
    rng = np.random.default_rng(seed)
    belief = Belief(model, objects)
    step = first_step(model, objects)
    truth = dict(zip(belief.atoms, rng.random(len(belief.atoms)) < 0.5, strict=True))
    belief.start(frozenset(), {a: Reading(bool(v)) for a, v in truth.items()})
    begin = time.process_time()
    for _ in range(LOOKS):
        wrong = rng.random(len(belief.atoms)) < 0.05
        told = {a: Reading(bool(v != w)) for (a, v), w in zip(truth.items(), wrong, strict=True)}
        belief.advance(step, StepStatus.DONE, frozenset(step.add - set(belief.atoms)), told)
        assert belief.state is not None
    return len(belief.atoms), 1000 * (time.process_time() - begin) / LOOKS


def first_step(model: WorldModel, objects: list[Object]) -> GroundOperator:
    """Some instance of an operator with visual effects, or of any."""
    visual = [o for o in model.operators if any(isinstance(a.predicate.source, FromVLM) for a in o.add | o.delete)]
    return next(step for operator in [*visual, *model.operators] for step in operator.groundings({}, objects))


def copied(model: WorldModel, copies: int) -> WorldModel:
    """``model`` with every selected visual predicate, and what is said of it, so many times."""
    visual = {p for p in model.selected if isinstance(p.source, FromVLM)}

    def renamed(atoms: Iterable[LiftedAtom], k: int) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(twin(a.predicate, k), a.variables) for a in atoms)

    def twin(predicate: Predicate, k: int) -> Predicate:
        return replace(predicate, name=f"{predicate.name}-{k}") if predicate in visual else predicate

    def of_first_copy(o: Operator) -> Operator:
        conditions, add, delete = renamed(o.preconditions, 0), renamed(o.add, 0), renamed(o.delete, 0)
        return replace(o, preconditions=conditions, add=add, delete=delete)

    def said(invariant: Invariant, k: int) -> Invariant:
        if isinstance(invariant, MutexGroup):
            return replace(invariant, atoms=renamed(invariant.atoms, k))
        (premise,), (conclusion,) = renamed([invariant.premise], k), renamed([invariant.conclusion], k)
        return replace(invariant, premise=premise, conclusion=conclusion)

    return replace(
        model,
        selected=tuple(twin(p, k) for p in model.selected for k in range(copies)),
        operators=tuple(map(of_first_copy, model.operators)),
        reliability=tuple(replace(r, predicate=twin(r.predicate, k)) for r in model.reliability for k in range(copies)),
        invariants=tuple(dict.fromkeys(said(i, k) for i in model.invariants for k in range(copies))),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", default="combo")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--copies", type=int, nargs="*", default=[1, 10, 40])
    parser.add_argument("--out", type=Path, default=Path("runs/acting"))
    given = parser.parse_args()
    domain = load_domain("burger")
    model, _ = learned(domain, given.family, given.seed, 0.02, "robust", given.out)
    objects = list(domain.tasks(given.family, given.seed, 1)[0].task.objects)
    rows = []
    for copies in given.copies:
        rows.append(per_look(copied(model, copies), objects, given.seed))
        print(f"{copies} copies, {rows[-1][0]} atoms: {rows[-1][1]:.2f} ms of CPU time per look", flush=True)
    atoms, milliseconds = zip(*rows, strict=True)
    print(f"200 atoms: {np.interp(200, atoms, milliseconds):.2f} ms")


if __name__ == "__main__":
    main()
