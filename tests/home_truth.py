"""Perfect symbols for the home domains, straight from the simulator's worlds, without drawing a picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pix2pred.domains.home.domain import HomeDomain, Start
from pix2pred.domains.home.episode import HomeEnvironment
from pix2pred.domains.home.world import World
from pix2pred.execution.episode import open_loop
from pix2pred.execution.parameters import Parameters
from pix2pred.planning import AStar, Planner, Search
from pix2pred.predicates import ground_atoms
from pix2pred.structs import (
    Atom,
    Candidate,
    FromVLM,
    LabelledDemo,
    LiftedAtom,
    Object,
    Operator,
    PlanStatus,
    Predicate,
    TruthTable,
)
from pix2pred.structs.environment import StepStatus

ValueOf = Callable[[World, str, Sequence[str]], bool]
Shape = tuple[Any, ...]


def visual(domain: HomeDomain, types: Mapping[str, Sequence[str]]) -> dict[str, Predicate]:
    """Visual predicates by name; ``types`` has the type names of their arguments."""
    return {n: Predicate(n, tuple(domain.rules.types[t] for t in ts), FromVLM(n)) for n, ts in types.items()}


def worlds_of(domain: HomeDomain, index: int, seed: int) -> list[World]:
    """The worlds before, between and after the skills of a demonstration."""
    recipe, world = domain.recipes[index], domain.demonstration_world(seed, index)
    goal = domain.goal_of(Start(world, recipe.goal))
    environment = HomeEnvironment(domain.rules, world, goal)
    worlds = [world]
    for action in domain.actions_of(recipe, world):
        step = environment.execute(action)
        assert step.status is StepStatus.DONE, step.detail
        worlds.append(environment.world)
    assert environment.goal_reached()
    return worlds


def true_atoms(
    domain: HomeDomain, world: World, predicates: Mapping[Predicate, str], value: ValueOf
) -> tuple[tuple[Object, ...], frozenset[Atom]]:
    """The objects of ``world``, and the given and visual atoms that hold; ``predicates`` have a concept each."""
    objects = domain.rules.objects(world)
    atoms = ground_atoms((*domain.rules.given, *predicates), objects)
    return objects, frozenset(a for a in atoms if _holds(domain, world, a, predicates, value))


def true_table(domain: HomeDomain, predicates: Mapping[Predicate, str], value: ValueOf, seed: int = 0) -> TruthTable:
    """The demonstrations with every predicate labelled perfectly."""
    demos = []
    for index, recipe in enumerate(domain.recipes):
        worlds = worlds_of(domain, index, seed)
        objects = domain.rules.objects(worlds[0])
        atoms = ground_atoms((*domain.rules.given, *predicates), objects)
        values = np.array([[_holds(domain, w, a, predicates, value) for a in atoms] for w in worlds], dtype=np.int8)
        goal = tuple(sorted(domain.goal_of(Start(worlds[0], recipe.goal))))
        demos.append(LabelledDemo(recipe.name, objects, domain.actions_of(recipe, worlds[0]), goal, atoms, values))
    candidates = tuple(Candidate(p, float(p.arity)) for p in sorted(predicates))
    return TruthTable(domain.rules.given, candidates, tuple(demos))


def with_wrong_labels(truth: TruthTable, rate: float, seed: int) -> TruthTable:
    """The same with a share ``rate`` of what a model labels turned round, given predicates included."""
    rng, demos = np.random.default_rng([seed, 7]), []
    for demo in truth.demos:
        seen = np.array([isinstance(a.predicate.source, FromVLM) for a in demo.atoms])
        wrong = (rng.random(demo.values.shape) < rate) & seen
        demos.append(replace(demo, values=np.where(wrong, 1 - demo.values, demo.values).astype(np.int8)))
    return replace(truth, demos=tuple(demos))


def _holds(domain: HomeDomain, world: World, atom: Atom, predicates: Mapping[Predicate, str], value: ValueOf) -> bool:
    concept = predicates.get(atom.predicate)
    if concept is None:
        return domain.rules.holds(world, atom)
    return value(world, concept, [o.name for o in atom.objects])


def planned_and_run(
    domain: HomeDomain,
    start: Start,
    model: Sequence[Operator],
    predicates: Mapping[Predicate, str],
    value: ValueOf,
    search: Search | None = None,
) -> int:
    """The number of steps of a plan from perfect labels, a shortest one unless another search is given.

    Fails when there is none or it misses the goal.
    """
    objects, atoms = true_atoms(domain, start.world, predicates, value)
    goal = domain.goal_of(start)
    found = Planner(search or AStar()).plan(model, objects, atoms, goal)
    assert found.status == PlanStatus.SOLVED
    episode = HomeEnvironment(domain.rules, start.world, goal)
    outcome = open_loop(found.plan, episode, Parameters({}, np.random.default_rng(0)))
    assert outcome.goal_reached, outcome.detail
    return len(found.plan)


def shape(op: Operator) -> Shape:
    """An operator with the numbers and the given or invented origin of its predicates left out."""

    def atoms(group: frozenset[LiftedAtom]) -> frozenset[tuple[str, ...]]:
        return frozenset((a.predicate.name.rstrip("01"), *(v.name for v in a.variables)) for a in group)

    parameters = tuple((v.name, v.type.name) for v in op.parameters)
    skill = (op.skill.name, tuple(v.name for v in op.skill_args))
    return op.name, parameters, skill, atoms(op.preconditions), atoms(op.add), atoms(op.delete)


def ordered(shape: Shape) -> Shape:
    """A shape whose sets are sorted, so that shapes can be compared by what they print."""
    return tuple(tuple(sorted(part)) if isinstance(part, frozenset) else part for part in shape)
