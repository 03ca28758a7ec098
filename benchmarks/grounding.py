"""CPU seconds and peak memory to ground operators of 8 parameters.

    python benchmarks/grounding.py [--operators 20000]

Three kinds of operators over one typed world of places, vehicles and goods, each with about the number asked for of
reachable instances: ``static``, whose preconditions on facts that never change pin the parameters down; ``chained``,
which becomes applicable step by step as goods arrive; ``weak``, half of whose parameters no precondition mentions.
"""

from __future__ import annotations

import argparse
import time
import tracemalloc
from dataclasses import dataclass

from pix2pred.planning import ground
from pix2pred.structs import AbstractState, Atom, FromDomain, LiftedAtom, Object, Operator, Predicate, Skill, Type
from pix2pred.structs import Variable as Var

THING = Type("thing")
PLACE, VEHICLE, GOOD = (Type(name, parent=THING) for name in ("place", "vehicle", "good"))


def predicate(name: str, *types: Type) -> Predicate:
    return Predicate(name, types, FromDomain())


ROAD, TOLL = predicate("Road", PLACE, PLACE), predicate("Toll", PLACE, VEHICLE)
FITS, WITH = predicate("Fits", GOOD, VEHICLE), predicate("With", GOOD, GOOD)
IN, AT = predicate("In", VEHICLE, PLACE), predicate("At", GOOD, PLACE)
A, B, C = (Var(f"?{n}", PLACE) for n in "abc")
V, W = Var("?v", VEHICLE), Var("?w", VEHICLE)
G, H, K = (Var(f"?{n}", GOOD) for n in "ghk")
PARAMETERS = (A, B, C, V, W, G, H, K)


@dataclass(frozen=True)
class Workload:
    name: str
    operator: Operator
    objects: tuple[Object, ...]
    initial: AbstractState
    goal: tuple[Atom, ...]


def workload(name: str, operators: int) -> Workload:
    """A world in which about ``operators`` instances of one operator with 8 parameters are reachable."""
    if name == "weak":
        return _weak(operators)
    stretches = max(1, round(operators / 64))  # 2 vehicles x 8 goods x 2 x 2 companions on each
    places = [Object(f"p{i:05}", PLACE) for i in range(stretches + 2)]
    vehicles = [Object(f"v{i}", VEHICLE) for i in range(4)]
    goods = [Object(f"g{i}", GOOD) for i in range(8)]
    pairs = [(goods[i], goods[(i + j) % 8]) for i in range(8) for j in (1, 3)]
    facts = {ROAD(places[i], places[i + 1]) for i in range(stretches + 1)}
    facts |= {TOLL(p, v) for p in places for v in vehicles[:2]}
    facts |= {FITS(g, vehicles[2]) for g in goods} | {WITH(*pair) for pair in pairs}
    start = places if name == "static" else places[:1]
    facts |= {IN(vehicles[0], p) for p in start} | {IN(vehicles[1], p) for p in start}
    pre = [
        LiftedAtom(ROAD, (A, B)), LiftedAtom(ROAD, (B, C)), LiftedAtom(TOLL, (C, V)), LiftedAtom(IN, (V, A)),
        LiftedAtom(FITS, (G, W)), LiftedAtom(WITH, (G, H)), LiftedAtom(WITH, (H, K)),
    ]  # fmt: skip
    add = frozenset({LiftedAtom(AT, (G, C)), LiftedAtom(IN, (V, B))})
    operator = _operator(frozenset(pre), add, frozenset({LiftedAtom(IN, (V, A))}))
    return Workload(name, operator, (*places, *vehicles, *goods), frozenset(facts), (AT(goods[0], places[-1]),))


def _weak(operators: int) -> Workload:
    """Half of the parameters stand in one precondition of their own or in none."""
    count = max(4, round((operators / 24) ** (1 / 5)) + 2)
    places = [Object(f"p{i}", PLACE) for i in range(count)]
    vehicles = [Object(f"v{i}", VEHICLE) for i in range(4)]
    goods = [Object(f"g{i}", GOOD) for i in range(count)]
    facts = {IN(v, places[0]) for v in vehicles} | {WITH(goods[0], g) for g in goods[1:]}
    pre = frozenset({LiftedAtom(IN, (V, A)), LiftedAtom(WITH, (G, H))})
    operator = _operator(pre, frozenset({LiftedAtom(IN, (V, B)), LiftedAtom(AT, (K, C))}), pre - {min(pre)})
    return Workload("weak", operator, (*places, *vehicles, *goods), frozenset(facts), (AT(goods[1], places[-1]),))


def _operator(pre: frozenset[LiftedAtom], add: frozenset[LiftedAtom], delete: frozenset[LiftedAtom]) -> Operator:
    return Operator("Deliver", PARAMETERS, pre, add, delete - add, Skill("Deliver", ()), ())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--operators", type=int, default=20_000)
    wanted = parser.parse_args().operators
    print("workload   ground operators   facts   seconds   peak MB")
    for name in ("static", "chained", "weak"):
        made = workload(name, wanted)
        arguments = ([made.operator], made.objects, made.initial, made.goal)
        start = time.process_time()
        task = ground(*arguments)
        seconds = time.process_time() - start
        tracemalloc.start()
        ground(*arguments)
        peak = tracemalloc.get_traced_memory()[1] / 2**20
        tracemalloc.stop()
        print(f"{name:<10} {len(task.instances):>16,} {len(task.atoms):>7,} {seconds:>9.2f} {peak:>9.1f}")


if __name__ == "__main__":
    main()
