"""What looking after every skill is good for: disturbances and wrong labels at test time, with and without it.

    python benchmarks/replanning.py RUNS --seeds 5 --count 10 --jobs 2

RUNS is the folder in which ``pix2pred demo --family F --seed 0`` has left its runs (default runs/demo), one per family;
their world models are used as they are. Labels come from the offline reader; in the column "2 % labels" a seeded 2 %
of them are flipped. Prints Markdown.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from joblib import Parallel, delayed

from pix2pred.execution import Solver
from pix2pred.predicates import Labeller, LabelSettings
from pix2pred.registry import load_domain, load_planner
from pix2pred.runs.layout import MODEL
from pix2pred.structs.formats.world_model import load_model
from pix2pred.structs.views import View
from pix2pred.vlm.noise.oracle import NoiseRates, NoisyOracle
from pix2pred.vlm.offline.model import ReaderModel
from pix2pred.vlm.offline.pixels import Scene

FAMILIES = ("more-stacks", "bigger", "combo")


@dataclass(frozen=True)
class Condition:
    name: str
    disturb: float
    flip: float
    closed_loop: bool


CONDITIONS = (
    Condition("undisturbed, open loop", 0.0, 0.0, False),
    Condition("undisturbed, closed loop", 0.0, 0.0, True),
    Condition("10 % disturbed, open loop", 0.1, 0.0, False),
    Condition("10 % disturbed, closed loop", 0.1, 0.0, True),
    Condition("2 % labels flipped, open loop", 0.0, 0.02, False),
    Condition("2 % labels flipped, closed loop", 0.0, 0.02, True),
)


def noisy_reader(model: ReaderModel, types: dict[str, str], flip: float, seed: int) -> NoisyOracle:
    """The reader's own values, some of them flipped."""

    scenes: dict[str, Scene] = {}

    def value(view: View, word: str, names: Sequence[str]) -> bool | None:
        digest = view.picture.image.digest
        if digest not in scenes:
            scenes.clear()
            scenes[digest] = Scene(view.picture)
        return model.value(word, names, [types[n] for n in names], scenes[digest])[0]

    return NoisyOracle([], value, NoiseRates(flip=flip), seed)


def solved(runs: Path, family: str, seed: int, count: int, condition: Condition) -> int:
    domain = load_domain("burger")
    assert domain.reader is not None
    model = load_model(runs / f"burger-{family}-seed0" / "run" / MODEL)
    reader = ReaderModel.load(domain.reader)
    total = 0
    for task in domain.tasks(family, seed, count):
        types = {o.name: o.type.name for o in task.task.objects}
        labeller = Labeller(noisy_reader(reader, types, condition.flip, seed), LabelSettings())
        solver = Solver(model, load_planner("portfolio"), labeller, condition.closed_loop)
        environment = domain.environment(task.task, task.simulator, condition.disturb)
        total += solver.solve(task.task, environment).solved
    return total


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path, nargs="?", default=Path("runs/demo"))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    jobs = [(f, c, s) for f in FAMILIES for c in CONDITIONS for s in range(arguments.seeds)]
    results = Parallel(n_jobs=arguments.jobs, verbose=1)(
        delayed(solved)(arguments.runs, f, s, arguments.count, c) for f, c, s in jobs
    )
    found = dict(zip(jobs, results, strict=True))
    print(f"| solved of {arguments.seeds * arguments.count} | " + " | ".join(FAMILIES) + " |")
    print("|---|" + "---|" * len(FAMILIES))
    for c in CONDITIONS:
        counts = [sum(found[f, c, s] for s in range(arguments.seeds)) for f in FAMILIES]
        print(f"| {c.name} | " + " | ".join(map(str, counts)) + " |")


if __name__ == "__main__":
    main()
