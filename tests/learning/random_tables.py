"""Random small truth tables with structure: skills with hidden effects, side objects, and label noise."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from random import Random

import numpy as np

from pix2pred.structs import (
    Action,
    Atom,
    Candidate,
    FromDomain,
    FromVLM,
    LabelledDemo,
    Object,
    Predicate,
    Skill,
    TruthTable,
    Type,
)

THING = Type("thing")
BALL = Type("ball", parent=THING)
BOX = Type("box", parent=THING)
TYPES = (THING, BALL, BOX)


def given(name: str, *types: Type) -> Predicate:
    return Predicate(name, types, FromDomain())


def candidate(name: str, *types: Type) -> Predicate:
    return Predicate(name, types, FromVLM(name))


GIVEN = (given("Lit"), given("Clear", THING), given("In", THING, THING))
POOL = (candidate("hot", BALL), candidate("near", BALL, BOX), candidate("noisy"))
SKILLS = (Skill("Go", ()), Skill("Heat", (BALL,)), Skill("Touch", (THING,)), Skill("Put", (THING, BOX)))


def demo(
    name: str,
    objects: Iterable[Object],
    actions: Sequence[Action],
    states: Sequence[Iterable[Atom]],
    goal: Iterable[Atom] = (),
) -> LabelledDemo:
    """A demonstration from its true atoms, state by state."""
    held = [set(s) for s in states]
    atoms = tuple(sorted(set().union(*held)))
    values = np.array([[a in s for a in atoms] for s in held], dtype=np.int8).reshape(len(held), len(atoms))
    return LabelledDemo(name, tuple(sorted(objects)), tuple(actions), tuple(sorted(goal)), atoms, values)


def table(
    initial: Iterable[Predicate],
    pool: Iterable[Predicate],
    demos: Iterable[LabelledDemo],
    costs: Mapping[str, float] | None = None,
) -> TruthTable:
    candidates = (Candidate(p, (costs or {}).get(p.name, float(p.arity))) for p in pool)
    return TruthTable(tuple(initial), tuple(candidates), tuple(demos))


def random_table(seed: int, noise: float | None = None, interchangeable: bool = True) -> TruthTable:
    """Demonstrations of skills with fixed effects, on their arguments and perhaps on objects beside them.

    ``interchangeable`` lets effects reach up to two side objects; without, effects stay on the arguments.
    """
    rng = Random(seed)
    level = rng.choice((0.0, 0.0, 0.02, 0.1)) if noise is None else noise
    predicates = rng.sample((*GIVEN, *POOL), rng.randint(2, 6))
    skills = rng.sample(SKILLS, rng.randint(1, 3))
    effects = {s: [_effects(rng, s, predicates, interchangeable) for _ in range(rng.randint(1, 2))] for s in skills}
    demos = [_random_demo(rng, i, predicates, effects, level) for i in range(rng.randint(1, 4))]
    initial = [p for p in predicates if p in GIVEN]
    return table(initial, [p for p in predicates if p in POOL], demos)


Slots = tuple[tuple[bool, Predicate, tuple[int, ...]], ...]
"""(added, predicate, slots): slots below the skill's arity are arguments, the others side objects."""


def _effects(rng: Random, skill: Skill, predicates: Sequence[Predicate], interchangeable: bool) -> Slots:
    slots = len(skill.types) + (rng.choice((0, 1, 2)) if interchangeable else 0)
    found = []
    for p in rng.choices(predicates, k=rng.randint(0, 3)):
        if slots or not p.arity:
            found.append((rng.random() < 0.6, p, tuple(rng.randrange(slots) for _ in p.types)))
    return tuple(found)


def _random_demo(
    rng: Random, index: int, predicates: Sequence[Predicate], effects: Mapping[Skill, list[Slots]], noise: float
) -> LabelledDemo:
    objects = [Object(f"o{i}", rng.choice(TYPES)) for i in rng.sample(range(8), rng.randint(1, 5))]
    every = [
        Atom(p, args)
        for p in predicates
        for args in product(objects, repeat=p.arity)
        if all(o.type.is_a(t) for o, t in zip(args, p.types, strict=True))
    ]
    state = {a for a in every if rng.random() < 0.3}
    states, actions = [set(state)], []
    for _ in range(rng.randint(0, 5)):
        skill = rng.choice(list(effects))
        fitting = [[o for o in objects if o.type.is_a(t)] for t in skill.types]
        if not all(fitting):
            continue
        args = tuple(rng.choice(group) for group in fitting)
        bound = [*args, *rng.choices(objects, k=2)]
        for added, p, slots in rng.choice(effects[skill]):
            atom = Atom(p, tuple(bound[i] for i in slots))
            if atom in every:
                state = state | {atom} if added else state - {atom}
        state = {a for a in every if (a in state) != (rng.random() < noise)}
        states.append(set(state))
        actions.append(Action(skill, args))
    return demo(f"demo-{index}", objects, actions, states)
