"""Nodes and CPU seconds on larger problems of the published domains, per planner.

    python benchmarks/larger_problems.py [--planners gbfs-ff,astar-lmcut,portfolio] [--only stacks]

More Stacks: 12 burgers among 33 objects (60 steps). Combo: 5 burgers of four layers among 33 objects. Juice: 17
objects, one to three drinks. Every plan is checked by code that knows nothing of the searches.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

from pix2pred.planning import is_valid
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.registry import load_planner

DOMAINS = Path(__file__).parents[1] / "tests" / "data" / "pddl"
Fill = dict[str, int]
"""Objects of each kind."""


def numbered(kind: str, count: int) -> list[str]:
    return [f"{kind}{i + 1}" for i in range(count)]


def burgers(domain: str, kinds: Fill, goal: str) -> str:
    """Everything on the ground, clear and raw; ``goal`` in PDDL."""
    things = {kind: numbered(kind, count) for kind, count in kinds.items()}
    objects = " ".join(f"{' '.join(names)} - {kind}" for kind, names in things.items())
    free = [name for names in things.values() for name in names]
    hand = "(clear5 robot)" if domain == "combo-burger" else "(empty_hands0 robot)"
    init = " ".join(f"(clear {x})" for x in (*free, "grill", "board", "robot"))
    init += hand + " ".join(f"(onground {x})" for x in free)
    return (
        f"(define (problem larger) (:domain {domain}) (:objects robot - robot grill - grill board - cutting_board"
        f" {objects}) (:init {init}) (:goal (and {goal})))"
    )


def stacks(count: int, others: Fill) -> str:
    goal = " ".join(f"(somewhereaboveandprepped bottom_bun{i} patty{i})" for i in range(1, count + 1))
    return burgers("more-stacks-burger", {"patty": count, "bottom_bun": count} | others, goal)


def combo(count: int, others: Fill) -> str:
    layers = {"patty": count, "bottom_bun": count, "lettuce": count, "top_bun": count}
    goal = " ".join(
        f"(somewhereaboveandprepped bottom_bun{i} patty{i}) (somewhereaboveandprepped patty{i} lettuce{i})"
        f" (on top_bun{i} lettuce{i})"
        for i in range(1, count + 1)
    )
    return burgers("combo-burger", layers | others, goal)


def juice(cups: int, fruits: int, drinks: int) -> str:
    cup, fruit = numbered("cup", cups), numbered("fruit", fruits)
    init = "".join(f"(empty {c}) (iscup0 {c}) (isplastic0 {c})" for c in cup)
    init += "".join(f"(outsidejuicemachine0 {f})" for f in fruit)
    goal = " ".join(f"(juiceincup fruit{i} cup{i})" for i in range(1, drinks + 1))
    return (
        f"(define (problem larger) (:domain juice) (:objects robot - robot juicer - juicer {' '.join(cup)} - container"
        f" {' '.join(fruit)} - movable_object) (:init {init} (functional0 juicer) (handempty0 robot)"
        f" (juicemachineopen0 juicer)) (:goal (and {goal})))"
    )


def problems() -> Iterator[tuple[str, str, str]]:
    """(name, domain, problem in PDDL)."""
    for count in (6, 9, 12):
        others = {"lettuce": 2, "cheese": 2, "top_bun": 26 - 2 * count}
        yield f"stacks, {count} burgers", "more-stacks-burger", stacks(count, others)
    for count in (2, 3, 5):
        yield f"combo, {count} burgers", "combo-burger", combo(count, {"cheese": 30 - 4 * count})
    for drinks in (1, 2, 3):
        yield f"juice, {drinks} drinks", "juice", juice(10, 5, drinks)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--planners", default="gbfs-ff,astar-lmcut,portfolio")
    parser.add_argument("--only", default="")
    args = parser.parse_args()
    for name, domain_name, text in problems():
        if args.only not in name:
            continue
        domain = read_domain((DOMAINS / f"{domain_name}-domain.pddl").read_text())
        task = read_problem(text, domain)
        for planner in args.planners.split(","):
            made = load_planner(planner, distinct=domain.distinct)
            start = time.process_time()
            found = made.plan(domain.operators, task.objects, task.initial, task.goal)
            seconds = time.process_time() - start
            assert not found.plan or is_valid(found.plan, task.initial, task.goal)
            print(
                f"{name:<18} {len(task.objects)} objects  {planner:<12} {found.status:<10} {len(found.plan):>3} steps"
                f" {found.nodes:>8} nodes {seconds:>7.2f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
