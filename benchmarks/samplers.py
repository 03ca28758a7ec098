"""Does learning where to push matter? Kettles on the right of the stove, where the height of the push decides.

    python benchmarks/samplers.py --seeds 5 --tries 20 --out runs/samplers

Demonstrations push the kettle onto burner 3 (its knob is on) at heights drawn evenly between 25 cm below and 10 cm
above the handle; many of them fail, which makes them negative examples. From the first 3, 10, 30 and 100 of them a
sampler is learned, and tried on kettles that were never demonstrated. It is compared with drawing evenly from the
skill's whole box, with drawing only the height evenly from the demonstrated range, and with replaying the mean of all
demonstrations or of those that succeeded. Every seed has demonstrations and kettles of its own. Cells are kept in
``rows.json`` as they are finished: the same command, started again, makes those that are missing.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from pix2pred.domains.kitchen.classifiers import true_atoms
from pix2pred.domains.kitchen.environment import KitchenEnvironment
from pix2pred.domains.kitchen.scenes import KETTLE_PUSH, RIGHT, boiling, push_kettle
from pix2pred.domains.kitchen.vocabulary import INITIAL, OBJECTS, PUSH_KETTLE
from pix2pred.domains.kitchen.world import KitchenWorld, standing_world
from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.learning.samplers.learn import SamplerFitter, fit_gaussian, learn_samplers
from pix2pred.learning.samplers.networks import fit_networks
from pix2pred.structs import Demo, LabelledDemo, Operator, State, TruthTable
from pix2pred.structs.samplers import Sampler, UniformSampler
from pix2pred.system.files import write_whole

SIZES = (3, 10, 30, 100)
LOWEST, HIGHEST = -0.25, 0.10
HEIGHT = 2
"""Which of the four parameters the height is."""

EVENLY = ("the whole box", "the height alone")
METHODS = ("default", "torch", "mean of all", "mean of those that worked")

Params = tuple[float, ...]


@dataclass(frozen=True)
class Push:
    """A push that was tried, and whether the kettle boils afterwards."""

    demo: Demo
    labels: LabelledDemo
    params: Params
    worked: bool


def start(rng: np.random.Generator) -> KitchenWorld:
    return standing_world(RIGHT, float(rng.uniform(0.4, 0.55)), (0.0, 0.0, -0.6, 0.0))


def demonstrate(seed: int, index: int) -> Push:
    rng = np.random.default_rng(np.random.SeedSequence((seed, 11, index)))
    world = start(rng)
    spread = rng.normal(0, (0.01, 0.005, 0.0, 0.03))
    params = np.array(KETTLE_PUSH) + spread
    params[HEIGHT] = rng.uniform(LOWEST, HIGHEST)
    return push(world, tuple(float(p) for p in params), index)


def push(world: KitchenWorld, params: Params, index: int) -> Push:
    environment = KitchenEnvironment(world, boiling("3"))
    action = push_kettle("3", params)
    states, held = [], []
    for skill in (None, action):
        if skill is not None:
            environment.execute(skill)
        held.append(true_atoms(environment.data))
        states.append(State((), environment.features(), held[-1]))
    name = f"push-{index}"
    atoms = tuple(sorted(held[0] | held[1] | set(boiling("3"))))
    values = np.array([[atom in state for atom in atoms] for state in held], dtype=np.int8)
    demo = Demo(name, OBJECTS, tuple(states), (action,), boiling("3"))
    labels = LabelledDemo(name, OBJECTS, (action,), boiling("3"), atoms, values)
    return Push(demo, labels, params, environment.goal_reached())


def pushing_operator(pushes: Sequence[Push]) -> Operator | None:
    """The learned operator that makes the kettle boil, if a push of it was demonstrated."""
    table = TruthTable(INITIAL, (), tuple(p.labels for p in pushes))
    operators = learn_operators(table, LearningSettings(operators="cluster-and-intersect"))
    return next((op for op in operators if op.add), None)


def learned(pushes: Sequence[Push], fit: SamplerFitter) -> tuple[Sampler, tuple[str, ...]] | None:
    """A sampler and the objects of its operator's parameters in order; nothing when every push failed."""
    operator = pushing_operator(pushes)
    if operator is None:
        return None
    samplers = learn_samplers((operator,), [p.demo for p in pushes], [p.labels for p in pushes], fit)
    names = {"gripper": "gripper", "kettle": "kettle", "surface": "burner3", "knob": "knob3"}
    return samplers[operator.name], tuple(names[v.type.name] for v in operator.parameters)


def draws(
    sampler: Sampler, names: Sequence[str], worlds: Sequence[KitchenWorld], seed: int
) -> tuple[list[Params], float]:
    """Parameters for every world, and how many draws were rejected on average."""
    by_name = {o.name: o for o in OBJECTS}
    objects = [by_name[n] for n in names]
    found, rejections = [], 0
    for i, world in enumerate(worlds):
        rng = np.random.default_rng(np.random.SeedSequence((seed, 13, i)))
        draw = sampler.sample(KitchenEnvironment(world, ()).features(), objects, rng)
        found.append(draw.params)
        rejections += draw.rejections
    return found, rejections / len(worlds)


@dataclass(frozen=True)
class Trial:
    """One seed: its demonstrations, and the kettles that every method is tried on."""

    seed: int
    pushes: Sequence[Push]
    worlds: Sequence[KitchenWorld]

    def methods(self, size: int) -> dict[str, Callable[[], tuple[list[Params], float] | None]]:
        """What to do with the first ``size`` demonstrations: parameters for every kettle and rejections per draw."""
        chosen = self.pushes[:size]
        worked = [p for p in chosen if p.worked]
        return {
            METHODS[0]: lambda: self._learned(chosen, fit_gaussian),
            METHODS[1]: lambda: self._learned(chosen, fit_networks),
            METHODS[2]: lambda: self._replayed(chosen),
            METHODS[3]: lambda: self._replayed(worked),
        }

    def evenly(self) -> dict[str, Callable[[], tuple[list[Params], float] | None]]:
        """What needs no demonstration."""
        box = UniformSampler(PUSH_KETTLE.low, PUSH_KETTLE.high)
        heights = np.random.default_rng(np.random.SeedSequence((self.seed, 14))).uniform(
            LOWEST, HIGHEST, len(self.worlds)
        )
        return {
            EVENLY[0]: lambda: draws(box, ("kettle",), self.worlds, self.seed),
            EVENLY[1]: lambda: ([(*KETTLE_PUSH[:HEIGHT], float(h), KETTLE_PUSH[3]) for h in heights], 0.0),
        }

    def _learned(self, pushes: Sequence[Push], fit: SamplerFitter) -> tuple[list[Params], float] | None:
        made = learned(pushes, fit)
        return draws(*made, self.worlds, self.seed) if made else None

    def _replayed(self, pushes: Sequence[Push]) -> tuple[list[Params], float] | None:
        if not pushes:
            return None
        mean = np.mean([p.params for p in pushes], axis=0)
        return [tuple(float(v) for v in mean)] * len(self.worlds), 0.0


class Rows:
    """Finished cells by name, in a JSON file."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.cells: dict[str, dict[str, Any]] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    def make(self, key: str, cell: Callable[[], dict[str, Any]]) -> None:
        """Make a cell unless it is there."""
        if key not in self.cells:
            self.cells[key] = cell()
            write_whole(self._path, json.dumps(self.cells, indent=1, sort_keys=True).encode())
            print(key, self.cells[key], flush=True)

    def sum(self, keys: Sequence[str]) -> str:
        """How many of the tries under ``keys`` worked, with rejections per draw; tries without a sampler failed."""
        cells = [self.cells[key] for key in keys]
        worked, tries = (sum(c[name] for c in cells) for name in ("worked", "tries"))
        untaught = sum(not c["made"] for c in cells)
        rejected = sum(c["rejected"] for c in cells) / max(1, len(cells) - untaught)
        note = f", {rejected:.1f} rejected a draw" if rejected else ""
        return f"{worked}/{tries} ({100 * worked / tries:.0f} %{note}{f', {untaught} untaught' if untaught else ''})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("runs/samplers"))
    parser.add_argument("--tries", type=int, default=20, help="unseen kettles per seed and sampler")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="numbers of demonstrations")
    parser.add_argument("--seeds", type=int, default=5, help="this many, from 0")
    parser.add_argument("--jobs", type=int, default=1)
    args = parser.parse_args()
    begin = time.perf_counter()
    args.out.mkdir(parents=True, exist_ok=True)
    rows = Rows(args.out / "rows.json")

    def tried(trial: Trial, method: Callable[[], tuple[list[Params], float] | None]) -> dict[str, Any]:
        drawn = method()
        params, rejected = drawn or ([], 0.0)
        pairs = zip(trial.worlds, params, strict=bool(drawn))
        found = Parallel(n_jobs=args.jobs)(delayed(push)(w, p, 0) for w, p in pairs)
        worked = sum(f.worked for f in found)
        return {"worked": worked, "tries": len(trial.worlds), "rejected": round(rejected, 2), "made": drawn is not None}

    most = max(args.sizes)
    for seed in range(args.seeds):
        prefix = f"seed {seed}, {args.tries} tries"
        names = [f"{prefix}, {size} demonstrations" for size in args.sizes]
        wanted = [f"{prefix}, {e}" for e in EVENLY] + [f"{name}, {m}" for name in names for m in ("good", *METHODS)]
        if rows.cells.keys() >= set(wanted):
            continue
        pushes = Parallel(n_jobs=args.jobs)(delayed(demonstrate)(seed, i) for i in range(most))
        rng = np.random.default_rng(np.random.SeedSequence((seed, 12)))
        trial = Trial(seed, pushes, [start(rng) for _ in range(args.tries)])
        for name, method in trial.evenly().items():
            rows.make(f"{prefix}, {name}", partial(tried, trial, method))
        for size, name in zip(args.sizes, names, strict=True):
            good = sum(p.worked for p in pushes[:size])
            rows.make(f"{name}, good", partial(dict, worked=good))
            for method_name, method in trial.methods(size).items():
                rows.make(f"{name}, {method_name}", partial(tried, trial, method))
    print(table(rows, args.sizes, args.seeds, args.tries))
    print(f"\n{time.perf_counter() - begin:.0f} s")


def table(rows: Rows, sizes: Sequence[int], seeds: int, tries: int) -> str:
    """All cells, summed over the seeds, in Markdown."""
    prefixes = [f"seed {seed}, {tries} tries" for seed in range(seeds)]
    lines = [f"evenly from {name}: {rows.sum([f'{p}, {name}' for p in prefixes])}" for name in EVENLY]
    lines += ["", f"| demonstrations | of which worked | {' | '.join(METHODS)} |", "|---" * (2 + len(METHODS)) + "|"]
    for size in sizes:
        keys = [f"{p}, {size} demonstrations" for p in prefixes]
        good = ", ".join(str(rows.cells[f"{key}, good"]["worked"]) for key in keys)
        lines.append(f"| {size} | {good} | {' | '.join(rows.sum([f'{k}, {m}' for k in keys]) for m in METHODS)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
