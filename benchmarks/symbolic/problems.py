"""The domains, and problems of them: small ones with optimal plans to learn from, larger ones to be tested on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from random import Random

from pix2pred.planning import AStar, GreedyBestFirst, Planner
from pix2pred.planning.pddl_read import PddlDomain, PddlProblem, read_domain
from pix2pred.structs import AbstractState, Atom, GroundOperator, Object, Operator, PlanStatus, Skill
from symbolic import manipulation, missions, puzzles, transporting
from symbolic.instance import Instance

FOLDER = Path(__file__).parent / "domains"
DEMOS, TESTS = 12, 10
SHORTEST, LONGEST = 3, 15
OPTIMAL = Planner(AStar(max_nodes=20_000))
GREEDY = Planner(GreedyBestFirst(max_nodes=20_000))
COVERED = 3
"""In how many demonstrations every action (by types of its arguments) should occur, if drawing can make it."""

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
    """A domain by its file's name. ``skill_args``: ``all`` makes every action a skill with all its parameters,
    ``subset`` takes the skills of the file's ``;@ skill`` comments, as a robot has them.
    """  # noqa: D205
    domain = read_domain((FOLDER / f"{name}.pddl").read_text(encoding="utf-8"))
    if skill_args == "subset":
        return domain
    return replace(domain, operators=tuple(_with_all_arguments(op) for op in domain.operators))


def _with_all_arguments(op: Operator) -> Operator:
    return replace(op, skill=Skill(op.name, tuple(v.type for v in op.parameters)), skill_args=op.parameters)


def to_problem(domain: PddlDomain, name: str, instance: Instance) -> PddlProblem:
    """An instance in words as objects and atoms of ``domain``."""
    types = {t.name: t for t in domain.types}
    objects = {o: Object(o, types[t]) for o, t in instance.objects.items()}
    predicates = {p.name: p for p in domain.predicates}

    def atom(text: str) -> Atom:
        word, *args = text.split()
        return Atom(predicates[word], tuple(objects[a] for a in args))

    goal = tuple(sorted({atom(a) for a in instance.goal}))
    return PddlProblem(name, tuple(sorted(objects.values())), frozenset(map(atom, instance.init)), goal)


@cache
def demonstrations(name: str, seed: int) -> tuple[SolvedProblem, ...]:
    """Small problems with shortest plans; drawn until every kind of step is shown, if that can be."""
    pool: list[SolvedProblem] = []
    shown: Counter[tuple[str, ...]] = Counter()
    for solved in _solved(name, seed, large=False):
        pool.append(solved)
        shown.update(_kinds(solved))
        if len(pool) >= 4 * DEMOS or (len(pool) >= 2 * DEMOS and min(shown.values()) >= COVERED):
            break
    chosen: list[SolvedProblem] = []
    seen: Counter[tuple[str, ...]] = Counter()
    while len(chosen) < DEMOS:
        rest = [s for s in pool if s not in chosen]
        best = max(rest, key=lambda s: sum(seen[kind] < COVERED for kind in _kinds(s)))
        chosen.append(best)
        seen.update(_kinds(best))
    return tuple(chosen)


@cache
def tests(name: str, seed: int) -> tuple[SolvedProblem, ...]:
    """Larger problems that the greedy planner solves in the true domain."""
    return tuple(solved for solved, _ in zip(_solved(name, seed, large=True), range(TESTS), strict=False))


def _kinds(solved: SolvedProblem) -> set[tuple[str, ...]]:
    return {(step.operator.name, *(o.type.name for o in step.objects)) for step in solved.plan}


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
