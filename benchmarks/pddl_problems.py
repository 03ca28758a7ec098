"""Seconds to ground and solve all published PDDL problems, summed per planner.

python benchmarks/pddl_problems.py
"""

from __future__ import annotations

import re
from pathlib import Path

from pix2pred.planning import is_valid
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.registry import load_planner

PROBLEMS = Path(__file__).parents[1] / "tests" / "data" / "pddl"


def main() -> None:
    for planner in ("gbfs-ff", "quick", "astar-lmcut"):
        seconds, solved, steps = 0.0, 0, 0
        for path in sorted(PROBLEMS.glob("*.pddl")):
            text = path.read_text()
            named = re.search(r":domain ([\w-]+)", text)
            if named is None:
                continue
            domain = read_domain((PROBLEMS / f"{named[1]}-domain.pddl").read_text())
            task = read_problem(text, domain)
            found = load_planner(planner, distinct=domain.distinct).plan(
                domain.operators, task.objects, task.initial, task.goal
            )
            seconds += found.seconds
            steps += len(found.plan)
            solved += bool(found.plan) and is_valid(found.plan, task.initial, task.goal)
        print(f"{planner}: {solved} solved, {steps} steps, {seconds:.2f} s")


if __name__ == "__main__":
    main()
