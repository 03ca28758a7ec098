"""Does learning where to push matter? Kettles on the right of the stove, where the height of the push decides.

    python benchmarks/samplers.py --tries 30

Demonstrations push the kettle onto burner 3 (its knob is on) at heights drawn evenly between 25 cm below and 10 cm
above the handle; many of them fail, which makes them negative examples. From the first 3, 10, 30 and 100 of them a
sampler is learned, and tried on kettles that were never demonstrated. It is compared with drawing evenly from the
skill's whole box, with drawing only the height evenly from the demonstrated range, and with replaying the mean of all
demonstrations or of those that succeeded.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from joblib import Parallel, delayed

from pix2pred.domains.kitchen.classifiers import true_atoms
from pix2pred.domains.kitchen.environment import KitchenEnvironment
from pix2pred.domains.kitchen.scenes import KETTLE_PUSH, RIGHT, boiling, push_kettle
from pix2pred.domains.kitchen.vocabulary import INITIAL, OBJECTS, PUSH_KETTLE
from pix2pred.domains.kitchen.world import World, standing_world
from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.learning.samplers import SamplerFitter, fit_gaussian, learn_samplers
from pix2pred.learning.samplers_torch import fit_networks
from pix2pred.structs import Demo, LabelledDemo, Operator, State, TruthTable
from pix2pred.structs.samplers import Sampler, UniformSampler

SIZES = (3, 10, 30, 100)
LOWEST, HIGHEST = -0.25, 0.10
HEIGHT = 2
"""Which of the four parameters the height is."""

Params = tuple[float, ...]


@dataclass(frozen=True)
class Push:
    """A push that was tried, and whether the kettle boils afterwards."""

    demo: Demo
    labels: LabelledDemo
    params: Params
    worked: bool


def start(rng: np.random.Generator) -> World:
    return standing_world(RIGHT, float(rng.uniform(0.4, 0.55)), (0.0, 0.0, -0.6, 0.0))


def demonstrate(seed: int, index: int) -> Push:
    rng = np.random.default_rng(np.random.SeedSequence((seed, 11, index)))
    world = start(rng)
    spread = rng.normal(0, (0.01, 0.005, 0.0, 0.03))
    params = np.array(KETTLE_PUSH) + spread
    params[HEIGHT] = rng.uniform(LOWEST, HIGHEST)
    return push(world, tuple(float(p) for p in params), index)


def push(world: World, params: Params, index: int) -> Push:
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
    operators = learn_operators(table, LearningSettings())
    return next((op for op in operators if op.add), None)


def learned(pushes: Sequence[Push], fit: SamplerFitter) -> tuple[Sampler, tuple[str, ...]] | None:
    """A sampler and the objects of its operator's parameters in order; nothing when every push failed."""
    operator = pushing_operator(pushes)
    if operator is None:
        return None
    samplers = learn_samplers((operator,), [p.demo for p in pushes], [p.labels for p in pushes], fit)
    names = {"gripper": "gripper", "kettle": "kettle", "surface": "burner3", "knob": "knob3"}
    return samplers[operator.name], tuple(names[v.type.name] for v in operator.parameters)


def draws(sampler: Sampler, names: Sequence[str], worlds: Sequence[World], seed: int) -> tuple[list[Params], float]:
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tries", type=int, default=30, help="unseen kettles per sampler")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="numbers of demonstrations")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    args = parser.parse_args()
    begin = time.perf_counter()
    pushes = Parallel(n_jobs=args.jobs)(delayed(demonstrate)(args.seed, i) for i in range(max(args.sizes)))
    rng = np.random.default_rng(np.random.SeedSequence((args.seed, 12)))
    worlds = [start(rng) for _ in range(args.tries)]

    def success(params: Sequence[Params]) -> str:
        tried = Parallel(n_jobs=args.jobs)(delayed(push)(w, p, 0) for w, p in zip(worlds, params, strict=True))
        return f"{sum(t.worked for t in tried)}/{len(tried)}"

    box = UniformSampler(PUSH_KETTLE.low, PUSH_KETTLE.high)
    anywhere, _ = draws(box, ("kettle",), worlds, args.seed)
    heights = [(*KETTLE_PUSH[:HEIGHT], float(rng.uniform(LOWEST, HIGHEST)), KETTLE_PUSH[3]) for _ in worlds]
    print(f"evenly from the whole box: {success(anywhere)}; only the height evenly: {success(heights)}", flush=True)
    print("\n| demonstrations | of which worked | default | torch | mean of all | mean of those that worked |")
    print("|---|---|---|---|---|---|", flush=True)
    for size in args.sizes:
        chosen = pushes[:size]
        cells = []
        for fit in (fit_gaussian, fit_networks):
            made = learned(chosen, fit)
            if made is None:
                cells.append("nothing to learn from")
            else:
                params, rejected = draws(*made, worlds, args.seed)
                cells.append(f"{success(params)} ({rejected:.1f} rejected a draw)")
        for group in (chosen, [p for p in chosen if p.worked]):
            mean = np.mean([p.params for p in group], axis=0) if group else np.full(4, np.nan)
            cells.append(success([tuple(float(v) for v in mean)] * len(worlds)))
        print(f"| {size} | {sum(p.worked for p in chosen)} | {' | '.join(cells)} |", flush=True)
    print(f"\n{time.perf_counter() - begin:.0f} s")


if __name__ == "__main__":
    main()
