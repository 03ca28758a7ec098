"""What a person's corrections buy: tasks solved after the first suggested fixes, and after as many random ones.

    python benchmarks/correcting.py --out runs/correcting

Labels of the candidates are flipped and the published learner learns from them. In the first draws in which it then
solves less than half of the test tasks, the true values of the first labels that ``advise`` names are put in, all of
them at once, without learning in between; a suggestion whose label was right is a fix without effect. For comparison,
as many labels are put right that are drawn at random from all wrong ones. Plans are made from true labels, with few
search nodes, and executed in the simulator.

OUT/rows.jsonl has a line per draw; rows that are already there are not computed again.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from burger_pool import Workload, workload, wrong_labels
from noise import domain, solved
from pix2pred.learning import LearningSettings, hill_climbing
from pix2pred.learning.labels.advice import advise, with_labels
from pix2pred.planning import AStar, GreedyBestFirst, Planner, Portfolio
from pix2pred.structs import Atom, TruthTable

Cell = tuple[str, Atom, int]
"""(demonstration, atom, state)."""


def run(family: str, rate: float, draw: int, candidates: int, fixes: int, tasks: int) -> dict[str, Any]:
    """One draw; the figures after fixes are missing where there was little to fix."""
    source = workload(family, candidates, seed=draw)
    table = wrong_labels(source.table, rate, draw)
    settings = LearningSettings.model_validate({**domain().settings(family), "operators": "cluster-and-intersect"})
    row: dict[str, Any] = {"family": family, "rate": rate, "draw": draw, "candidates": candidates, "tasks": tasks}
    row["before"] = score(source, table, settings, draw, tasks)
    if 2 * row["before"]["solved"] >= tasks:
        return row
    wrong = wrong_cells(source.table, table)
    start = time.process_time()
    advice = advise(table, settings)
    suggested = [(a.demo, a.atom, a.doubt.state) for a in advice.labels]
    row["advice_seconds"] = round(time.process_time() - start, 2)
    row["suggested_wrong"] = sum(cell in wrong for cell in suggested[:fixes])
    row["wrong"] = len(wrong)
    order = sorted(wrong)
    drawn = [order[i] for i in np.random.default_rng([draw, 8]).permutation(len(order))[:fixes]]
    for name, cells in (("suggested", suggested[:fixes]), ("random", drawn)):
        row[name] = score(source, put_right(table, source.table, cells), settings, draw, tasks)
    return row


def score(source: Workload, table: TruthTable, settings: LearningSettings, draw: int, tasks: int) -> dict[str, Any]:
    """Learn from ``table`` and solve tasks."""
    planner = Planner(Portfolio((AStar(max_nodes=500), GreedyBestFirst(max_nodes=4_000))))
    selection = hill_climbing(table, settings).run()
    return {
        "solved": solved(source.family, selection, source.meaning, draw, tasks, planner=planner),
        "selected": [p.name for p in selection.selected],
        "right": source.right(selection.selected),
        "J": round(selection.steps[-1].j, 1),
        "operators": len(selection.operators),
    }


def wrong_cells(true: TruthTable, table: TruthTable) -> set[Cell]:
    """Where the labels of ``table`` are not the true ones."""
    return {
        (demo.name, demo.atoms[i], int(state))
        for demo, other in zip(true.demos, table.demos, strict=True)
        for state, i in np.argwhere(demo.values != other.values)
    }


def put_right(table: TruthTable, true: TruthTable, cells: Sequence[Cell]) -> TruthTable:
    """``table`` with the true values in ``cells``."""
    demos = {demo.name: demo for demo in true.demos}
    values: Mapping[Cell, int] = {
        (name, atom, state): int(demos[name].values[state, demos[name].atoms.index(atom)])
        for name, atom, state in cells
    }
    return with_labels(table, values)


def summary(rows: Sequence[Mapping[str, Any]]) -> str:
    """A table of the draws that were corrected, and the medians."""
    lines = ["| draw | before | suggested fixes | random fixes | suggestions that were errors |", "|---" * 5 + "|"]
    shares: dict[str, list[float]] = {"before": [], "suggested": [], "random": []}
    for row in rows:
        if "suggested" not in row:
            continue
        for name, values in shares.items():
            values.append(100 * row[name]["solved"] / row["tasks"])
        cells = [f"{values[-1]:.0f} %" for values in shares.values()]
        lines.append(f"| {row['draw']} | {' | '.join(cells)} | {row['suggested_wrong']} |")
    if shares["before"]:
        lines.append(f"| median | {' | '.join(f'{median(v):.0f} %' for v in shares.values())} | |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", default="combo")
    parser.add_argument("--rate", type=float, default=0.05)
    parser.add_argument("--draws", type=int, default=10, help="draws with less than half of the tasks solved")
    parser.add_argument("--candidates", type=int, default=98)
    parser.add_argument("--fixes", type=int, default=10)
    parser.add_argument("--tasks", type=int, default=10)
    parser.add_argument("--out", type=Path, default=Path("runs/correcting"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    path = arguments.out / "rows.jsonl"
    known = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    rows: list[dict[str, Any]] = []
    draw = 0
    with path.open("a") as stream:
        while sum("suggested" in row for row in rows) < arguments.draws:
            asked = (arguments.family, arguments.rate, draw, arguments.candidates, arguments.tasks)
            row = next((r for r in known if tuple(r[k] for k in KEY) == asked), None)
            if row is None:
                row = run(*asked[:4], arguments.fixes, arguments.tasks)
                stream.write(json.dumps(row) + "\n")
                stream.flush()
            rows.append(row)
            draw += 1
    (arguments.out / "correcting.md").write_text(summary(rows))
    print(summary(rows), end="")


KEY = ("family", "rate", "draw", "candidates", "tasks")


if __name__ == "__main__":
    main()
