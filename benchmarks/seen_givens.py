"""Given predicates that a model labels, too: what is learned then, against given predicates that are certain.

    python benchmarks/seen_givens.py competition --noise 0 0.02 --seed 7 --skill-args subset
    python benchmarks/seen_givens.py burger --demos 2 --noise 0 0.02 --draws 10

In a project of one's own photos every given predicate is labelled by the model. Here those of the planning-competition
domains and of the burger kitchens are: their labels, of all their ground atoms, are turned round as often as those of
candidates. ``certain`` has the same candidates and errors, and given predicates without errors, as the other
benchmarks do. ``--demos`` takes so many demonstrations, chosen by the draw, in place of
twelve. Numbers are test problems solved; a star says that other predicates than the hidden ones were selected.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from burger_pool import NEEDED, workload
from noise import solved
from pix2pred.learning import LearningSettings, hill_climbing
from pix2pred.predicates import ground_atoms
from pix2pred.structs import Atom, FromSkills, FromVLM, Label, LabelledDemo, TruthTable
from symbolic.problems import CATALOGUE
from symbolic.score import score_model
from symbolic.traces import make_traces

WHAT = ("certain", "seen")
UNSEEN = ("Holding", "HandEmpty")
"""Given predicates of the burger kitchen that a project has from its skills."""


def seen(table: TruthTable, flip: float, seed: int, unseen: Sequence[str] = ()) -> TruthTable:
    """``table`` with its given predicates labelled by a model that errs: every ground atom's label, at this rate."""
    rng = np.random.default_rng([seed, 29])
    sources = {
        p: replace(p, source=FromSkills() if p.name in unseen else FromVLM(p.name.lower())) for p in table.initial
    }
    demos = []
    for demo in table.demos:
        own = {a: i for i, a in enumerate(demo.atoms)}
        given = ground_atoms(tuple(table.initial), demo.objects)
        more = [a for a in given if a not in own]
        atoms = [*demo.atoms, *more]
        values = np.concatenate([demo.values, np.zeros((len(demo.values), len(more)), demo.values.dtype)], axis=1)
        noisy = np.array([isinstance(getattr(sources.get(a.predicate), "source", None), FromVLM) for a in atoms])
        wrong = (rng.random(values.shape) < flip) & noisy & (values != Label.UNKNOWN)
        values[wrong] = 1 - values[wrong]
        named = [Atom(sources.get(a.predicate, a.predicate), a.objects) for a in atoms]
        order = sorted(range(len(named)), key=named.__getitem__)
        goal = tuple(Atom(sources[a.predicate], a.objects) for a in demo.goal)
        demos.append(
            LabelledDemo(demo.name, demo.objects, demo.actions, goal, tuple(named[i] for i in order), values[:, order])
        )
    return TruthTable(tuple(sources.values()), table.pool, tuple(demos))


def chosen(table: TruthTable, count: int | None, draw: int) -> TruthTable:
    """The table with ``count`` demonstrations."""
    if count is None:
        return table
    picked = np.random.default_rng([draw, 31]).choice(len(table.demos), min(count, len(table.demos)), replace=False)
    return replace(table, demos=tuple(table.demos[i] for i in sorted(picked)))


def competition(given: argparse.Namespace) -> None:
    total = dict.fromkeys([(what, noise) for noise in given.noise for what in given.what], 0)
    for domain in given.domains:
        texts = []
        for noise in given.noise:
            source = make_traces(domain, given.seed, noise, skill_args=given.skill_args)
            table = chosen(source.table, given.demos, given.seed)
            for what in given.what:
                start = time.process_time()
                one = seen(table, noise, given.seed) if what == "seen" else table
                found = hill_climbing(one, LearningSettings(operators=given.operators)).run()
                seconds = time.process_time() - start
                score = score_model(source, [p.name for p in found.selected], found.operators, 3.0)
                total[what, noise] += score.solved
                right = sorted(p.name for p in found.selected) == sorted(source.hidden)
                size = f"{len(found.operators)} operators, {seconds:.1f} s"
                texts.append(f"{what} {noise:g}: {score.solved}{'' if right else '*'} ({size})")
                if given.verbose:
                    print(domain, what, noise, score, *found.operators, sep="\n", flush=True)
        print(domain, "|", "; ".join(texts), flush=True)
    print({f"{what} {noise:g}": n for (what, noise), n in total.items()})


def burger(given: argparse.Namespace) -> None:
    """``certain`` and ``seen``, and how often the operators are those of certain and right given predicates."""
    for family in given.families:
        for noise in given.noise:
            total = dict.fromkeys(given.what, 0)
            same = 0
            for draw in range(given.first, given.first + given.draws):
                source = workload(family, given.candidates, seed=draw)
                table = chosen(source.table, given.demos, draw)
                ops = {}
                for what in given.what:
                    one = seen(table, noise, draw, UNSEEN) if what == "seen" else table
                    found = hill_climbing(one, LearningSettings(operators=given.operators)).run()
                    ops[what] = {(o.skill.name, o.preconditions, o.add, o.delete) for o in found.operators}
                    total[what] += solved(family, found, source.meaning, draw, given.tasks)
                    if given.verbose:
                        names = [p.name for p in found.selected]
                        print(family, noise, draw, what, names, *found.operators, sep="\n", flush=True)
                same += len({frozenset(o) for o in ops.values()}) == 1
            print(family, noise, total, "of", given.draws * given.tasks, "same operators", same, flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("where", choices=("competition", "burger"))
    parser.add_argument("--domains", nargs="+", default=list(CATALOGUE), choices=list(CATALOGUE), metavar="NAME")
    parser.add_argument("--families", nargs="+", default=list(NEEDED))
    parser.add_argument("--noise", nargs="+", type=float, default=[0.0, 0.02])
    parser.add_argument("--what", nargs="+", default=list(WHAT), choices=WHAT)
    parser.add_argument("--seed", type=int, default=0, help="of the competition domains")
    parser.add_argument("--skill-args", choices=("all", "subset"), default="subset")
    parser.add_argument("--demos", type=int, help="demonstrations; otherwise all")
    parser.add_argument("--draws", type=int, default=5, help="of the burger kitchens")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--candidates", type=int, default=60)
    parser.add_argument("--tasks", type=int, default=5)
    parser.add_argument("--operators", default="robust")
    parser.add_argument("--verbose", action="store_true")
    given = parser.parse_args()
    {"competition": competition, "burger": burger}[given.where](given)


if __name__ == "__main__":
    main()
