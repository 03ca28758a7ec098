"""Selection measured: the default engine against exact-tree, a large workload, and how the cost grows.

    python benchmarks/selection.py ratio                 # both engines on the same workloads, in one process
    python benchmarks/selection.py large                 # 1,000 candidates x 100 demonstrations, 2 % of labels flipped
    python benchmarks/selection.py several --candidates 98 --flips 0 0.02 0.05 --operators robust   # 18 workloads
    python benchmarks/selection.py growth --out runs/selection   # cost per demonstration and per distinct column

Seconds are CPU seconds of this process. ``large`` prints the peak memory as well.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from burger_pool import NEEDED, Workload, workload, wrong_labels
from pix2pred.domains.burger import BurgerDomain
from pix2pred.learning import LearningSettings, Selection, hill_climbing
from pix2pred.structs import TruthTable


@dataclass(frozen=True)
class Measured:
    selection: Selection
    seconds: float


def settings(family: str, **changes: object) -> LearningSettings:
    return LearningSettings.model_validate({**BurgerDomain().settings(family), **changes})


def measure(table: TruthTable, chosen: LearningSettings) -> Measured:
    start = time.process_time()
    selection = hill_climbing(table, chosen).run()
    return Measured(selection, time.process_time() - start)


def meanings(source: Workload, selection: Selection) -> list[str]:
    return [source.meaning[p].removeprefix("not ") for p in selection.selected]


def ratio(arguments: argparse.Namespace) -> None:
    print("| family | flipped | exact-tree s | grouped s | ratio | same meanings | J exact-tree | J grouped |")
    print("|---|---|---|---|---|---|---|---|")
    for family in arguments.families:
        for flip in arguments.flips:
            source = workload(family, arguments.candidates, arguments.demos, seed=arguments.seed)
            table = wrong_labels(source.table, flip, arguments.seed)
            tree = measure(table, settings(family, engine="exact-tree", node_budget=arguments.node_budget))
            ours = measure(table, settings(family))
            same = meanings(source, tree.selection) == meanings(source, ours.selection)
            js = [m.selection.steps[-1].j for m in (tree, ours)]
            cells = [family, f"{flip:.0%}", f"{tree.seconds:.1f}", f"{ours.seconds:.2f}"]
            cells += [f"{tree.seconds / ours.seconds:.0f}", "yes" if same else "no", *(f"{j:.0f}" for j in js)]
            print(f"| {' | '.join(cells)} |", flush=True)


def several(arguments: argparse.Namespace) -> None:
    """Two draws of every family at every rate of wrong labels: seconds, and how often the choice is right."""
    for operators in arguments.operators:
        seconds, right = [], 0
        for family, seed in product(arguments.families, (arguments.seed, arguments.seed + 1)):
            source = workload(family, arguments.candidates, arguments.demos, seed=seed)
            for flip in arguments.flips:
                found = measure(wrong_labels(source.table, flip, seed), settings(family, operators=operators))
                seconds.append(found.seconds)
                right += source.right(found.selection.selected)
        print(f"{operators}: {right} of {len(seconds)} right, {sum(seconds):.1f} CPU s, the slowest {max(seconds):.2f}")


def large(arguments: argparse.Namespace) -> None:
    family = arguments.families[0]
    source = workload(family, 1000, 100, seed=arguments.seed)
    table = wrong_labels(source.table, 0.02, arguments.seed)
    for operators in arguments.operators:
        found = measure(table, settings(family, operators=operators))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        names = [p.name for p in found.selection.selected]
        print(f"{operators}: {found.seconds:.1f} CPU s, peak {peak:.0f} MB, selected {names}, "
              f"{'right' if source.right(found.selection.selected) else 'WRONG'}, "
              f"J {[round(s.j) for s in found.selection.steps]}", flush=True)  # fmt: skip


def growth(arguments: argparse.Namespace) -> None:
    """CPU seconds against demonstrations at 100 candidates, and against candidates at 12 demonstrations."""
    family = arguments.families[0]
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    sizes = [(100, d) for d in (12, 25, 50, 100)] + [(c, 12) for c in (125, 250, 500, 1000)]
    for candidates, demos in sizes:
        source = workload(family, candidates, demos, seed=arguments.seed)
        table = wrong_labels(source.table, 0.02, arguments.seed)
        for operators in arguments.operators:
            found = measure(table, settings(family, operators=operators))
            rows.append({
                "candidates": candidates, "demos": demos, "operators": operators,
                "scored": found.selection.scored, "steps": len(found.selection.steps), "seconds": found.seconds,
                "right": source.right(found.selection.selected),
            })  # fmt: skip
            print(rows[-1], flush=True)
    (arguments.out / "growth.json").write_text(json.dumps(rows, indent=1) + "\n")
    plot(rows, arguments.out / "growth.svg")


def plot(rows: Sequence[dict[str, object]], path: Path) -> None:
    """Seconds per demonstration and per candidate: flat is linear."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 3.2), layout="constrained")
    for axes, key, fixed in zip(figure.subplots(1, 2), ("demos", "candidates"), (100, 12), strict=True):
        other = "candidates" if key == "demos" else "demos"
        for operators in sorted({str(r["operators"]) for r in rows}):
            found = [r for r in rows if r["operators"] == operators and r[other] == fixed]
            axes.plot([r[key] for r in found], [r["seconds"] for r in found], marker="o", label=operators)
        axes.set_xlabel("demonstrations" if key == "demos" else key)
        axes.set(ylabel="CPU seconds", xlim=(0, None), ylim=(0, None))
        axes.set_title(f"{fixed} {other}")
        axes.grid(alpha=0.3)
        axes.legend()
    figure.savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("ratio", "large", "several", "growth"))
    parser.add_argument("--families", nargs="+", default=list(NEEDED), choices=list(NEEDED))
    parser.add_argument("--flips", nargs="+", type=float, default=[0.0, 0.02])
    parser.add_argument("--candidates", type=int, default=45)
    parser.add_argument("--demos", type=int, default=12)
    parser.add_argument("--operators", nargs="+", default=["cluster-and-intersect", "robust"])
    parser.add_argument("--node-budget", type=int, default=20_000, help="of exact-tree, in nodes per search")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("runs/selection"))
    arguments = parser.parse_args()
    {"ratio": ratio, "large": large, "several": several, "growth": growth}[arguments.what](arguments)


if __name__ == "__main__":
    main()
