"""Cleanup and Juice from end to end: what is learned from the reader's labels, and the tasks executed to the goal.

    python benchmarks/robot_domains.py --seeds 0 1 2 3 4 --count 3 --how open closed --out runs/robots

A model is learned for every domain and seed and kept in OUT; then the first COUNT tasks of every family are tried. A
line per domain, seed, family and way of acting goes to OUT/rows.jsonl; what is in it already is not done again, as long
as domain, reader and learner are the same. A plan counts as correct when executing it open loop in the simulator
reaches the goal. Failures are listed with their causes and the labels that were wrong.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from pix2pred.execution import Solver
from pix2pred.pipeline import LearningProblem, learn
from pix2pred.planning import TaskPlanner
from pix2pred.predicates import Labeller
from pix2pred.registry import REGISTRY, load_domain, load_planner, load_vlm
from pix2pred.settings import Settings, of_project, resolve
from pix2pred.structs import AbstractState, Atom, Object, Operator, PlanResult, WorldModel
from pix2pred.structs.environment import Domain, asking_settings
from pix2pred.structs.formats.world_model import dump_model, load_model
from pix2pred.vlm import VLM

FIVE = ("new-objects", "new-background", "more-objects", "novel-goal-1", "novel-goal-2")
WAYS = ("open", "closed")
LEARNERS = ("robust", "cluster-and-intersect")
"""The first is what projects have where nothing else is said; the other is the published one."""
Row = dict[str, Any]


def settings_of(domain: Domain, family: str, operators: str) -> Settings:
    """The published settings of a domain with another learner of operators."""
    learning = {**domain.settings(family), "operators": operators}
    return resolve(of_project({"learning": learning, **asking_settings(domain, family)}))


def learned(domain: Domain, seed: int, operators: str, vlm: VLM, out: Path) -> WorldModel:
    """The model of a seed, learned once: all families share their demonstrations."""
    path = out / "models" / f"{vlm.name.replace(':', '-')}-{operators}-{seed}.json"
    if not path.exists():
        family = domain.families[0]
        demos = tuple(domain.demonstrations(family, seed))
        settings = settings_of(domain, family, operators)
        result = learn(LearningProblem(domain.vocabulary(family), demos, vlm, settings))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dump_model(result.model))
    return load_model(path)


@dataclass(slots=True)
class Timed:
    """A planner that remembers the CPU seconds of its longest search."""

    planner: TaskPlanner
    slowest: float = 0.0

    def plan(
        self, operators: Sequence[Operator], objects: Iterable[Object], initial: AbstractState, goal: Iterable[Atom]
    ) -> PlanResult:
        begin = time.process_time()
        found = self.planner.plan(operators, objects, initial, goal)
        self.slowest = max(self.slowest, time.process_time() - begin)
        return found


def tried(domain: Domain, model: WorldModel, vlm: VLM, cell: Row) -> Row:
    """The row of a cell: its tasks, tried one after the other."""
    settings = settings_of(domain, cell["family"], cell["operators"])
    planner = Timed(load_planner("portfolio"))
    solver = Solver(model, planner, Labeller(vlm, settings.labels), cell["how"] == "closed")
    found = []
    for task in domain.tasks(cell["family"], cell["seed"], cell["tasks"]):
        environment = domain.environment(task.task, task.simulator)
        found.append(solver.solve(task.task, environment, REGISTRY.truth(domain, environment)))
    failed = [f"{e.task}: {e.failure}, {e.detail} {', '.join(e.label_errors)}".strip() for e in found if not e.solved]
    return cell | {
        "solved": sum(e.solved for e in found), "skills": [len(e.plan) for e in found],
        "slowest_plan": round(planner.slowest, 2), "failed": failed,
    }  # fmt: skip


def cells(arguments: argparse.Namespace) -> Iterator[Row]:
    """What the rows are about, in the order in which they are made."""
    for seed, domain in product(arguments.seeds, arguments.domains):
        for how, family in product(arguments.how, arguments.families):
            yield {"domain": domain, "seed": seed, "how": how, "family": family, "operators": arguments.operators}


def table(rows: Sequence[Row]) -> str:
    """Tasks reached by domain, way and family over all seeds."""
    families = list(dict.fromkeys(row["family"] for row in rows))
    lines = [f"| | {' | '.join(families)} | all |", "|---" * (len(families) + 2) + "|"]
    groups: dict[tuple[str, str], dict[str, Counter[str]]] = defaultdict(lambda: defaultdict(Counter))
    for row in rows:
        groups[row["domain"], row["how"]][row["family"]] += Counter(solved=row["solved"], tasks=row["tasks"])
    for (domain, how), by_family in groups.items():
        shown = [f"{by_family[f]['solved']} of {by_family[f]['tasks']}" for f in families]
        all_ = sum(by_family.values(), Counter())
        lines.append(f"| {domain}, {how} loop | {' | '.join(shown)} | {all_['solved']} of {all_['tasks']} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domains", nargs="+", default=["cleanup", "juice"])
    parser.add_argument("--families", nargs="+", default=list(FIVE))
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2, 3, 4])
    parser.add_argument("--how", nargs="+", choices=WAYS, default=list(WAYS))
    parser.add_argument("--count", type=int, default=3)
    parser.add_argument("--operators", choices=LEARNERS, default=LEARNERS[0])
    parser.add_argument("--out", type=Path, default=Path("runs/robots"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    store = arguments.out / "rows.jsonl"
    done = [json.loads(line) for line in store.read_text().splitlines()] if store.exists() else []
    rows = []
    for cell in cells(arguments):
        domain, vlm = load_domain(cell["domain"]), load_vlm("offline", cell["domain"])
        key = cell | {"vlm": vlm.name, "tasks": arguments.count}
        row = next((r for r in done if key.items() <= r.items()), None)
        if row is None:
            model = learned(domain, cell["seed"], cell["operators"], vlm, arguments.out)
            row = tried(domain, model, vlm, key)
            with store.open("a") as file:
                file.write(json.dumps(row) + "\n")
            where = f"{row['domain']} {row['family']} seed {row['seed']}, {row['how']} loop"
            said = f"{where}: {row['solved']} of {row['tasks']}, plans of {row['skills']}"
            print(said, *row["failed"], sep="\n    ", file=sys.stderr, flush=True)
        rows.append(row)
    print(table(rows))
    print(f"\nslowest search for a plan: {max(r['slowest_plan'] for r in rows):.2f} CPU s; readers: "
          + ", ".join(sorted({r["vlm"] for r in rows})))  # fmt: skip


if __name__ == "__main__":
    main()
