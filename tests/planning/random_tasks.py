"""Small random planning tasks and naive reference procedures to check the planners against."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from random import Random

from pix2pred.planning import GroundTask, Strips
from pix2pred.structs import (
    AbstractState,
    Atom,
    FromDomain,
    GroundOperator,
    LiftedAtom,
    Object,
    Operator,
    Predicate,
    Skill,
    Type,
    Variable,
)

THING = Type("thing")
BALL = Type("ball", parent=THING)
RED_BALL = Type("red_ball", parent=BALL)
BOX = Type("box", parent=THING)
TYPES = (THING, BALL, RED_BALL, BOX)


def predicate(name: str, *types: Type) -> Predicate:
    return Predicate(name, types, FromDomain())


PREDICATES = (predicate("Done"), predicate("Lit"), predicate("Clear", THING), predicate("Hot", BALL),
              predicate("In", THING, THING), predicate("Near", BALL, BOX))  # fmt: skip


def random_strips(seed: int, facts: int = 6, operators: int = 7) -> Strips:
    """A task on up to ``facts`` bits; operators may lack preconditions or effects, or add what they delete."""
    rng = Random(seed)
    n = rng.randint(1, facts)

    def mask(expected: float) -> int:
        return sum(1 << i for i in range(n) if rng.random() < expected / n)

    k = rng.randint(0, operators)
    return Strips(
        n,
        tuple(mask(1.3) for _ in range(k)),
        tuple(mask(1.2) for _ in range(k)),
        tuple(mask(0.8) for _ in range(k)),
        mask(1.5),
        mask(2.0),
    )


def shortest(task: Strips, start: int | None = None) -> int | None:
    """Length of a shortest plan by breadth-first search over sets of fact numbers; ``None`` if there is none."""

    def as_set(mask: int) -> frozenset[int]:
        return frozenset(i for i in range(task.facts) if mask >> i & 1)

    pre, add, delete = ([as_set(m) for m in group] for group in (task.pre, task.add, task.delete))
    goal = as_set(task.goal)
    layer = {as_set(task.initial if start is None else start)}
    seen = set(layer)
    for length in range(2**task.facts + 1):
        if any(goal <= state for state in layer):
            return length
        layer = {
            (state - d) | a for state in layer for p, a, d in zip(pre, add, delete, strict=True) if p <= state
        } - seen
        seen |= layer
    return None


def relaxed_reachable(task: Strips, state: int) -> bool:
    """Whether the goal is reached when nothing is ever deleted."""
    while True:
        grown = state
        for pre, add in zip(task.pre, task.add, strict=True):
            if pre & state == pre:
                grown |= add
        if grown == state:
            return task.goal & state == task.goal
        state = grown


def run(task: Strips, plan: Iterable[int]) -> int | None:
    """The state after ``plan``; ``None`` when a step is not applicable."""
    state = task.initial
    for k in plan:
        if task.pre[k] & state != task.pre[k]:
            return None
        state = state & ~task.delete[k] | task.add[k]
    return state


def random_lifted(seed: int) -> tuple[tuple[Operator, ...], tuple[Object, ...], frozenset[Atom], tuple[Atom, ...]]:
    """Operators, objects, initial atoms and a goal over ``TYPES`` and ``PREDICATES``, in no particular order."""
    rng = Random(seed)
    objects = tuple(Object(f"o{i}", rng.choice(TYPES)) for i in rng.sample(range(9), rng.randint(0, 4)))
    operators = tuple(_random_operator(rng, i) for i in range(rng.randint(0, 4)))
    every = [Atom(p, args) for p in PREDICATES for args in product(objects, repeat=p.arity)]
    initial = frozenset(a for a in every if rng.random() < 0.25)
    goal = tuple(rng.sample(every, rng.randint(0, min(2, len(every)))))
    return operators, objects, initial, goal


def _random_operator(rng: Random, number: int) -> Operator:
    variables = tuple(Variable(f"?x{i}", rng.choice(TYPES)) for i in range(rng.randint(0, 3)))

    def atoms(expected: float) -> frozenset[LiftedAtom]:
        found = set()
        for p in PREDICATES:
            if rng.random() < expected / len(PREDICATES) and (variables or not p.arity):
                found.add(LiftedAtom(p, tuple(rng.choice(variables) for _ in p.types)))
        return frozenset(found)

    skill_args = variables[:1]
    skill = Skill("Act", tuple(v.type for v in skill_args))
    return Operator(f"Op{number}", variables, atoms(1.5), atoms(1.5), atoms(1.0), skill, skill_args)


def naive_ground(
    operators: Sequence[Operator], objects: Sequence[Object], initial: AbstractState, distinct: bool
) -> tuple[set[tuple[str, tuple[Object, ...]]], set[Atom], list[GroundOperator]]:
    """(instances, reachable atoms, ground operators) by enumerating all bindings and a delete-free fixpoint."""
    instances = [
        op.ground(binding)
        for op in operators
        for binding in product(*([o for o in objects if o.type.is_a(v.type)] for v in op.parameters))
        if not distinct or len(set(binding)) == len(binding)
    ]
    reached = set(initial)
    while True:
        used = [g for g in instances if g.preconditions <= reached]
        grown = reached.union(*(g.add for g in used))
        if grown == reached:
            return {(g.operator.name, g.objects) for g in used}, reached, used
        reached = grown


def named(task: GroundTask) -> set[tuple[object, ...]]:
    """A ground task with atoms in place of bits: comparable whatever the numbering."""

    def atoms(mask: int) -> frozenset[Atom]:
        return frozenset(a for i, a in enumerate(task.atoms) if mask >> i & 1)

    strips = task.strips
    return {
        (op.name, objects, atoms(strips.pre[k]), atoms(strips.add[k]), atoms(strips.delete[k]))
        for k, (op, objects) in enumerate(task.instances)
    } | {("initial", atoms(strips.initial)), ("goal", atoms(strips.goal), task.goal_reachable)}
