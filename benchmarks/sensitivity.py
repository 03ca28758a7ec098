"""How much the published learner depends on its three settings, beside the robust learner, which has none to choose.

    python benchmarks/sensitivity.py --draws 2 --jobs 2 --out runs/sensitivity

For every J_thresh, h_pre_frac and h_data_frac: workloads of all families with 2 % of the candidates' labels flipped,
and the share of test tasks solved in the simulator. OUT/rows.jsonl holds every run (a second call goes on where the
first stopped), OUT/sensitivity.svg the figure.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from burger_pool import NEEDED, workload, wrong_labels
from pix2pred.domains.burger import BurgerDomain
from pix2pred.learning import LearningSettings, hill_climbing

THRESHOLDS = (200.0, 2000.0, 20000.0)
PRECONDITIONS = (0.6, 0.7, 0.8, 0.9, 1.0)
SHARES = (0.0, 0.05, 0.1, 0.25)
Setting = tuple[float, float, float]


def run(family: str, draw: int, setting: Setting | None, flip: float, tasks: int) -> dict[str, Any]:
    """One draw with one setting, or with the robust learner when ``setting`` is None."""
    from noise import solved

    source = workload(family, 60, seed=draw)
    table = wrong_labels(source.table, flip, draw)
    chosen = {**BurgerDomain().settings(family)}
    if setting is None:
        chosen["operators"] = "robust"
    else:
        chosen |= dict(zip(("j_threshold", "h_pre_frac", "h_data_frac"), setting, strict=True))
    selection = hill_climbing(table, LearningSettings.model_validate(chosen)).run()
    count = solved(family, selection, source.meaning, draw, tasks)
    return {"family": family, "draw": draw, "setting": setting, "solved": count, "tasks": tasks}


def figure(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """One map per threshold, with the robust learner's share in the title."""
    from matplotlib.figure import Figure

    def share(setting: Setting | None) -> float:
        wanted = list(setting) if setting else None
        found = [r["solved"] / r["tasks"] for r in rows if r["setting"] == wanted]
        return 100 * float(np.mean(found)) if found else float("nan")

    canvas = Figure(figsize=(3.2 * len(THRESHOLDS), 3.4), layout="constrained")
    for axes, threshold in zip(canvas.subplots(1, len(THRESHOLDS), sharey=True), THRESHOLDS, strict=True):
        values = np.array([[share((threshold, h, s)) for s in SHARES] for h in PRECONDITIONS])
        axes.imshow(values, vmin=0, vmax=100, cmap="YlGnBu", aspect="auto")
        for (y, x), value in np.ndenumerate(values):
            axes.text(x, y, f"{value:.0f}", ha="center", va="center", color="white" if value > 60 else "black")
        axes.set(title=f"J_thresh {threshold:g}", xlabel="h_data_frac", xticks=range(len(SHARES)), xticklabels=SHARES)
        axes.set(yticks=range(len(PRECONDITIONS)), yticklabels=PRECONDITIONS)
    canvas.axes[0].set_ylabel("h_pre_frac")
    canvas.suptitle(f"tasks solved in %, published learner; robust learner, nothing to set: {share(None):.0f} %")
    canvas.savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=2)
    parser.add_argument("--flip", type=float, default=0.02)
    parser.add_argument("--tasks", type=int, default=5)
    parser.add_argument("--families", nargs="*", default=list(NEEDED))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("runs/sensitivity"))
    arguments = parser.parse_args()
    from sensitivity import run as once  # by name of the module, so that workers import it

    arguments.out.mkdir(parents=True, exist_ok=True)
    path = arguments.out / "rows.jsonl"
    rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    done = {(r["family"], r["draw"], tuple(r["setting"]) if r["setting"] else None) for r in rows}
    settings: list[Setting | None] = [None, *product(THRESHOLDS, PRECONDITIONS, SHARES)]
    jobs = [(f, d, s) for f in arguments.families for d in range(arguments.draws) for s in settings]
    work = Parallel(n_jobs=arguments.jobs, return_as="generator")
    with path.open("a") as stream:
        for row in work(delayed(once)(*j, arguments.flip, arguments.tasks) for j in jobs if j not in done):
            stream.write(json.dumps(row) + "\n")
            stream.flush()
            rows.append(json.loads(json.dumps(row)))
    figure(rows, arguments.out / "sensitivity.svg")


if __name__ == "__main__":
    main()
