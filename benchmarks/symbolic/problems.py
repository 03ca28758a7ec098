"""The domains, and problems of them: small ones with optimal plans to learn from, larger ones to be tested on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from random import Random

from pix2pred.planning import AStar, GreedyBestFirst, Planner
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem, read_domain
from pix2pred.structs import AbstractState, Atom, GroundOperator, Object, Operator, PlanStatus, Skill
from symbolic import manipulation, missions, puzzles, transporting
from symbolic.instance import Instance

FOLDER = Path(__file__).parent / "domains"
DEMOS, TESTS = 12, 10
SHORTEST, LONGEST = 3, 15
OPTIMAL = Planner(AStar(max_nodes=20_000))
GREEDY = Planner(GreedyBestFirst(max_nodes=3_000))
POOL = 40
"""Small problems that are solved to choose the demonstrations from."""
NEW_KIND = 100
"""A step of a new kind counts as much as ruling out so many preconditions."""
COVERED = 3
"""Up to how many demonstrations of the same kind of step are worth more than none."""

Kind = tuple[str, ...]
"""An action and the types of its arguments."""
Lifted = tuple[str, tuple[int, ...]]
"""A predicate and the positions of its arguments among those of the action."""

Generator = Callable[[Random, bool], Instance]
Hide = tuple[tuple[str, ...], ...]
"""Sets of predicates of which one is hidden; none is used in goals, none can be done without."""

CATALOGUE: dict[str, tuple[Generator, Hide]] = {
    "bartender": (manipulation.bartender, (("clean",), ("free",), ("void", "shaken"))),
    "blocksworld": (manipulation.blocksworld, (("clear",), ("hand-empty",), ("hand-empty", "holding"))),
    "childsnack": (manipulation.childsnack, (("fresh",), ("in-kitchen",), ("fresh", "gluten-free"))),
    "depots": (manipulation.depots, (("available",), ("clear",), ("available", "lifting"))),
    "driverlog": (transporting.driverlog, (("empty",), ("driving",), ("driving", "empty"))),
    "ferry": (transporting.ferry, (("empty-ferry",), ("at-ferry",), ("aboard", "empty-ferry"))),
    "gripper": (manipulation.gripper, (("free",), ("at-robot",), ("at-robot", "free"))),
    "hanoi": (manipulation.hanoi, (("clear",),)),
    "keys": (puzzles.keys, (("arm-empty",), ("open",), ("arm-empty", "holding"))),
    "logistics": (transporting.logistics, (("in",),)),
    "miconic": (transporting.miconic, (("boarded",), ("lift-at",), ("boarded", "lift-at"))),
    "npuzzle": (puzzles.npuzzle, (("gap",),)),
    "parking": (transporting.parking, (("car-clear",), ("kerb-clear",), ("car-clear", "kerb-clear"))),
    "rovers": (missions.rovers, (("calibrated",), ("empty",), ("calibrated", "empty"))),
    "satellite": (missions.satellite, (("calibrated",), ("power-available",), ("calibrated", "power-on"))),
    "sokoban": (puzzles.sokoban, (("vacant",), ("keeper-at",))),
    "spanner": (puzzles.spanner, (("usable",), ("carrying",), ("carrying", "usable"))),
    "transport": (transporting.transport, (("capacity",), ("in",))),
    "visitall": (puzzles.visitall, (("robot-at",),)),
    "zenotravel": (transporting.zenotravel, (("fuel",), ("in",))),
}


@dataclass(frozen=True, slots=True)
class SolvedProblem:
    """A problem with a plan of the true domain and the states the plan passes through."""

    problem: PddlProblem
    plan: tuple[GroundOperator, ...]
    states: tuple[AbstractState, ...]


@cache
def load_domain(name: str, skill_args: str = "all") -> PddlDomain:
    """A domain by its file's name.

    ``skill_args``: ``all`` makes every action a skill with all its parameters, ``subset`` takes the skills of the
    file's ``;@ skill`` comments, which have fewer, as a robot's skills do.
    """
    domain = read_domain((FOLDER / f"{name}.pddl").read_text(encoding="utf-8"))
    if skill_args == "subset":
        return domain
    return replace(domain, operators=tuple(_with_all_arguments(op) for op in domain.operators))


def _with_all_arguments(op: Operator) -> Operator:
    return replace(op, skill=Skill(op.name, tuple(v.type for v in op.parameters)), skill_args=op.parameters)


def to_problem(domain: PddlDomain, name: str, instance: Instance) -> PddlProblem:
    """An instance in words as objects and atoms of ``domain``."""
    types = {t.name: t for t in domain.types}
    objects = {o: Object(o, types[t], o) for o, t in instance.objects.items()}
    predicates = {p.name: p for p in domain.predicates}

    def atom(text: str) -> Atom:
        word, *args = text.split()
        return Atom(predicates[word], tuple(objects[a] for a in args))

    goal = tuple(sorted({atom(a) for a in instance.goal}))
    return PddlProblem(name, tuple(sorted(objects.values())), frozenset(map(atom, instance.init)), goal)


@cache
def demonstrations(name: str, seed: int) -> tuple[SolvedProblem, ...]:
    """Small problems with shortest plans, each next one chosen to rule out most.

    Together they show every kind of step that was drawn and leave as little doubt as can be on what it needs.
    """
    pool = [solved for solved, _ in zip(_solved(name, seed, large=False), range(POOL), strict=False)]
    steps = {solved.problem.name: _steps(solved) for solved in pool}
    open_questions: dict[Kind, frozenset[Lifted]] = {}
    shown: Counter[Kind] = Counter()

    def gain(solved: SolvedProblem) -> tuple[int, int]:
        ruled_out, news = 0, 0
        for kind, held in steps[solved.problem.name].items():
            ruled_out += len(open_questions[kind] - held) if kind in open_questions else NEW_KIND
            news += shown[kind] < COVERED
        return ruled_out, news

    chosen: list[SolvedProblem] = []
    while len(chosen) < DEMOS:
        best = max((s for s in pool if s not in chosen), key=gain)
        chosen.append(best)
        for kind, held in steps[best.problem.name].items():
            open_questions[kind] = open_questions.get(kind, held) & held
            shown[kind] += 1
    return tuple(sorted(chosen, key=pool.index))


@cache
def tests(name: str, seed: int) -> tuple[SolvedProblem, ...]:
    """Larger problems that the greedy planner solves in the true domain."""
    return tuple(solved for solved, _ in zip(_solved(name, seed, large=True), range(TESTS), strict=False))


def _steps(solved: SolvedProblem) -> dict[Kind, frozenset[Lifted]]:
    """For every kind of step in a plan: what held of its arguments, beforehand, each time."""
    found: dict[Kind, frozenset[Lifted]] = {}
    for step, state in zip(solved.plan, solved.states, strict=False):
        position = {o: i for i, o in enumerate(step.objects)}
        held = frozenset(
            (a.predicate.name, tuple(position[o] for o in a.objects)) for a in state if position.keys() >= {*a.objects}
        )
        kind = (step.operator.name, *(o.type.name for o in step.objects))
        found[kind] = found.get(kind, held) & held
    return found


def _solved(name: str, seed: int, *, large: bool) -> Iterator[SolvedProblem]:
    generate, _ = CATALOGUE[name]
    domain = load_domain(name)
    kind = "test" if large else "demo"
    rng = Random(f"{name}/{seed}/{kind}")
    number = 0
    while True:
        problem = to_problem(domain, f"{kind}-{number}", generate(rng, large))
        found = (GREEDY if large else OPTIMAL).plan(domain.operators, problem.objects, problem.initial, problem.goal)
        fits = len(found.plan) > SHORTEST if large else SHORTEST <= len(found.plan) <= LONGEST
        if found.status == PlanStatus.SOLVED and fits:
            states = [problem.initial]
            for step in found.plan:
                states.append(step.apply(states[-1]))
            yield SolvedProblem(problem, found.plan, tuple(states))
            number += 1
