"""Tasks solved in the simulator against wrong labels in the demonstrations, for both operator learners.

    python benchmarks/noise.py --draws 10 --jobs 2 --out runs/noise

For every (family, error model, rate, draw): a pool of typed words is drawn, the candidates' labels are flipped, each
learner selects for itself, and 10 test tasks are planned with true labels and executed. OUT/rows.jsonl has a line per
run, and runs that are already in it are not repeated; OUT/noise.md is the table and OUT/noise.svg the figure.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import defaultdict
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from burger_pool import NEEDED, true_state, workload, wrong_labels
from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.execution.episode import open_loop
from pix2pred.execution.parameters import Parameters
from pix2pred.learning import LearningSettings, Selection, hill_climbing
from pix2pred.planning import TaskPlanner
from pix2pred.registry import load_planner
from pix2pred.structs import PlanStatus, groundings

LEARNERS = ("cluster-and-intersect", "robust")
ERRORS = ("independent", "sticky", "unknown", "test")
RATES = (0.0, 0.01, 0.02, 0.05, 0.1)


def run(family: str, errors: str, rate: float, draw: int, learner: str, candidates: int, tasks: int) -> dict[str, Any]:
    """One draw: learn from wrong labels and solve tasks with true ones."""
    source = workload(family, candidates, seed=draw)
    flip, unknown = (0.0, rate) if errors == "unknown" else (rate, 0.0)
    table = wrong_labels(source.table, flip, draw, unknown=unknown, sticky=errors == "sticky")
    settings = LearningSettings.model_validate({**domain().settings(family), "operators": learner})
    start = time.process_time()
    selection = hill_climbing(table, settings).run()
    seconds = time.process_time() - start
    return {
        "family": family, "errors": errors, "rate": rate, "draw": draw, "learner": learner,
        "selected": [p.name for p in selection.selected], "right": source.right(selection.selected),
        "operators": len(selection.operators), "J": [round(s.j, 1) for s in selection.steps],
        "solved": solved(family, selection, source.meaning, draw, tasks, flip if errors == "test" else 0.0),
        "tasks": tasks, "seconds": round(seconds, 2),
    }  # fmt: skip


@cache
def domain() -> BurgerDomain:
    return BurgerDomain()


@cache
def test_tasks(family: str, seed: int, count: int) -> Sequence[Any]:
    return domain().tasks(family, seed, count)


def solved(
    family: str, selection: Selection, meaning: Any, seed: int, count: int, flip: float = 0.0,
    planner: TaskPlanner | None = None,
) -> int:  # fmt: skip
    """Tasks solved when this share of the labels of selected predicates at test time is turned round."""
    total = 0
    rng = np.random.default_rng([seed, 1])
    predicates = (*domain().vocabulary(family).initial, *selection.selected)
    planner = planner or load_planner("portfolio")
    for item in test_tasks(family, seed, count):
        state = true_state(BurgerWorld.from_dict(item.simulator["world"]), predicates, meaning)
        atoms = [p(*args) for p in selection.selected for args in groundings(p.types, item.task.objects, distinct=True)]
        state ^= frozenset(atom for atom, wrong in zip(atoms, rng.random(len(atoms)) < flip, strict=True) if wrong)
        found = planner.plan(selection.operators, item.task.objects, state, item.task.goal)
        if found.status == PlanStatus.SOLVED and len(found.plan) <= 200:
            environment = domain().environment(item.task, item.simulator)
            environment.reset()
            total += open_loop(found.plan, environment, Parameters({}, np.random.default_rng(0))).goal_reached
    return total


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Share of solved tasks in percent, and of draws with the right choice."""
    cells: dict[tuple[str, str, str], dict[float, list[dict[str, Any]]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        cells[row["errors"], row["family"], row["learner"]][row["rate"]].append(row)
    rates = sorted({row["rate"] for row in rows})
    lines = ["| errors | family | learner | " + " | ".join(f"{r:.0%}" for r in rates) + " |"]
    lines.append("|---" * (3 + len(rates)) + "|")
    for key, by_rate in sorted(cells.items()):
        texts = []
        for rate in rates:
            found = by_rate.get(rate, [])
            share = 100 * sum(r["solved"] for r in found) / max(1, sum(r["tasks"] for r in found))
            right = sum(r["right"] for r in found)
            texts.append(f"{share:.0f} ({right}/{len(found)})" if found else "–")
        lines.append(f"| {' | '.join(key)} | {' | '.join(texts)} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=10)
    parser.add_argument("--candidates", type=int, default=98)
    parser.add_argument("--tasks", type=int, default=10)
    parser.add_argument("--families", nargs="*", default=list(NEEDED))
    parser.add_argument("--errors", nargs="*", default=["independent"], choices=ERRORS)
    parser.add_argument("--rates", nargs="*", type=float, default=list(RATES))
    parser.add_argument("--learners", nargs="*", default=list(LEARNERS))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("runs/noise"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    from noise import run as once  # by name of the module, so that workers import it

    jobs = [
        (f, e, r, d, learner, arguments.candidates, arguments.tasks)
        for f in arguments.families for e in arguments.errors for r in arguments.rates
        for d in range(arguments.draws) for learner in arguments.learners
    ]  # fmt: skip
    rows = _read(arguments.out / "rows.jsonl")
    done = {(r["family"], r["errors"], r["rate"], r["draw"], r["learner"]) for r in rows}
    todo = [job for job in jobs if job[:5] not in done]
    with (arguments.out / "rows.jsonl").open("a") as stream:
        for row in Parallel(n_jobs=arguments.jobs, return_as="generator")(delayed(once)(*job) for job in todo):
            stream.write(json.dumps(row) + "\n")
            stream.flush()
            rows.append(row)
    (arguments.out / "noise.md").write_text(table(rows))
    print(table(rows))
    figure(rows, arguments.out / "noise.svg")


def _read(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def figure(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Solved tasks in percent against the rate of errors; a column per family, a line per learner and error model."""
    from matplotlib.figure import Figure

    families = [f for f in NEEDED if any(r["family"] == f for r in rows)]
    canvas = Figure(figsize=(3.2 * len(families), 3.2), layout="constrained")
    for axes, family in zip(np.atleast_1d(canvas.subplots(1, len(families), sharey=True)), families, strict=True):
        for errors, style in (("independent", "-"), ("sticky", "--")):
            for learner, colour in zip(LEARNERS, ("#b4532a", "#1f6f8b"), strict=True):
                found = [r for r in rows if (r["family"], r["errors"], r["learner"]) == (family, errors, learner)]
                rates = sorted({r["rate"] for r in found})
                shares = [100 * np.mean([r["solved"] / r["tasks"] for r in found if r["rate"] == x]) for x in rates]
                label = f"{learner}, {errors}"
                axes.plot([100 * x for x in rates], shares, style, color=colour, marker="o", markersize=3, label=label)
        axes.set(title=family, xlabel="wrong labels, %", ylim=(-3, 103))
        axes.grid(alpha=0.3)
    canvas.axes[0].set_ylabel("tasks solved, %")
    canvas.legend(*canvas.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    canvas.savefig(path)


if __name__ == "__main__":
    main()
