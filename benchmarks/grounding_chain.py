"""CPU seconds and peak memory to ground a chain: one thing moves along COUNT places, one after the other.

python benchmarks/grounding_chain.py [COUNT] [--write DIR]    # also as domain.pddl and problem.pddl
"""

from __future__ import annotations

import argparse
import resource
import time
from pathlib import Path

from pix2pred.planning.pddl.compiling.ground import ground_pddl
from pix2pred.planning.pddl.read import read_domain, read_problem

DOMAIN = """(define (domain chain) (:predicates (at ?x) (next ?x ?y))
 (:action go :parameters (?x ?y) :precondition (and (at ?x) (next ?x ?y)) :effect (and (at ?y) (not (at ?x)))))"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int, nargs="?", default=50_000)
    parser.add_argument("--write", type=Path, help="a folder for domain.pddl and problem.pddl")
    args = parser.parse_args()
    count = args.count
    places = " ".join(f"p{i}" for i in range(count + 1))
    links = " ".join(f"(next p{i} p{i + 1})" for i in range(count))
    text = f"(define (problem p) (:domain chain) (:objects {places}) (:init (at p0) {links}) (:goal (at p{count})))"
    if args.write:
        args.write.mkdir(parents=True, exist_ok=True)
        (args.write / "domain.pddl").write_text(DOMAIN)
        (args.write / "problem.pddl").write_text(text)
    domain = read_domain(DOMAIN)
    problem = read_problem(text, domain)
    start = time.process_time()
    task = ground_pddl(domain, problem)
    seconds = time.process_time() - start
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    print(f"{len(task.steps)} operators, {task.strips.facts} facts, {seconds:.1f} s, {megabytes} MB")


if __name__ == "__main__":
    main()
