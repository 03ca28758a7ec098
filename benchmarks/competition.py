"""Learn planning-competition-like domains and solve larger problems of them with what was learned.

A domain gives 12 small demonstrations with 30 candidate predicates, one or two of them needed, and 10 larger problems.
A plan counts when it works in the true domain.

    python benchmarks/competition.py --noise 0 0.02 0.05 --seed 0
    python benchmarks/competition.py --told --set h_pre_frac=1 --set h_data_frac=0      # the needed ones are known
    python benchmarks/competition.py --domains ferry hanoi --operators robust --verbose
    python benchmarks/competition.py --write runs/traces                                # the traces, nothing learned
    python benchmarks/competition.py --pddl runs/pddl       # larger problems as drawn, for benchmarks/public_pddl.py

``--seed`` changes the problems, the candidates, what is hidden and the noise.
"""

from __future__ import annotations

import argparse
import gzip
import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from joblib import Parallel, delayed

from pix2pred.learning import LearningSettings, hill_climbing, learn_operators
from pix2pred.structs import Operator
from symbolic.problems import CATALOGUE, FOLDER, TESTS
from symbolic.score import MAX_SECONDS, Score, score_model
from symbolic.traces import Workload, make_traces


@dataclass(frozen=True, slots=True)
class Job:
    """One cell of the table."""

    domain: str
    noise: float
    seed: int
    told: bool
    settings: LearningSettings
    unknown: float = 0.0
    sticky: bool = False
    skill_args: str = "all"
    max_seconds: float = MAX_SECONDS

    def workload(self) -> Workload:
        """What is learned from."""
        return make_traces(self.domain, self.seed, self.noise, self.unknown, self.sticky, self.skill_args)


@dataclass(frozen=True, slots=True)
class Outcome:
    """A cell: what was selected, how many operators, CPU seconds of learning alone, and the verdicts."""

    selected: tuple[str, ...]
    hidden: tuple[str, ...]
    operators: tuple[Operator, ...]
    seconds: float
    score: Score


def run(job: Job) -> Outcome:
    """Learn from one workload and solve its test problems."""
    workload = job.workload()
    start = time.process_time()
    if job.told:
        selected, operators = workload.hidden, learn_operators(workload.told(), job.settings)
    else:
        selection = hill_climbing(workload.table, job.settings).run()
        selected, operators = tuple(p.name for p in selection.selected), selection.operators
    seconds = time.process_time() - start
    score = score_model(workload, selected, operators, job.max_seconds)
    return Outcome(selected, workload.hidden, operators, seconds, score)


def main() -> None:
    arguments = _parser().parse_args()
    chosen: dict[str, Any] = dict(pair.split("=", 1) for pair in arguments.set)
    if arguments.operators:
        chosen["operators"] = arguments.operators
    settings = LearningSettings.model_validate(chosen)
    extra = (arguments.unknown, arguments.sticky, arguments.skill_args, arguments.max_seconds)
    cells = [(domain, noise) for domain in arguments.domains for noise in arguments.noise]
    jobs = [Job(d, n, arguments.seed, arguments.told, settings, *extra) for d, n in cells]
    if arguments.pddl:
        for domain in arguments.domains:
            _write_pddl(arguments.pddl / domain, domain, arguments.seed)
        return
    if arguments.write:
        for job in jobs:
            _write(arguments.write / f"{job.domain}-seed{job.seed}-noise{job.noise}.json.gz", job.workload())
        return
    outcomes = Parallel(n_jobs=arguments.jobs, return_as="generator")(delayed(run)(job) for job in jobs)
    done = []
    for job, outcome in zip(jobs, outcomes, strict=True):
        done.append(outcome)
        if arguments.verbose:
            print(f"{job.domain} {job.noise}: {outcome.score}; selected {', '.join(outcome.selected) or 'nothing'}"
                  f" (hidden {', '.join(outcome.hidden)}), {len(outcome.operators)} operators, {outcome.seconds:.2f} s",
                  flush=True)  # fmt: skip
    _table(arguments.domains, arguments.noise, done)


def _table(domains: Sequence[str], noise: Sequence[float], outcomes: Sequence[Outcome]) -> None:
    rows = [outcomes[i : i + len(noise)] for i in range(0, len(outcomes), len(noise))]
    print("| domain | " + " | ".join(f"{100 * n:g} %" for n in noise) + " | hidden |")
    print("|---|" + "---|" * (len(noise) + 1))
    for domain, row in zip(domains, rows, strict=True):
        hidden = ", ".join(name.split("_", 1)[1] for name in row[0].hidden)
        print(f"| {domain} | " + " | ".join(str(o.score.solved) for o in row) + f" | {hidden} |")
    columns = list(zip(*rows, strict=True))
    print("| **solved** | " + " | ".join(f"**{sum(o.score.solved for o in c)}**" for c in columns) + " | "
          f"of {TESTS * len(domains)} |")  # fmt: skip
    print("| CPU seconds | " + " | ".join(f"{sum(o.seconds for o in c):.1f}" for c in columns) + " | learning alone |")


def _write(path: Path, workload: Workload) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(json.dumps(workload.document).encode(), mtime=0))
    print(f"{path}: hidden {', '.join(workload.hidden)}")


def _write_pddl(folder: Path, domain: str, seed: int) -> None:
    """The domain and ``TESTS`` larger problems, drawn without asking whether anybody solves them."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "domain.pddl").write_text((FOLDER / f"{domain}.pddl").read_text())
    generate, _ = CATALOGUE[domain]
    rng = Random(f"{domain}/{seed}/pddl")
    for i in range(TESTS):
        (folder / f"p{i:02}.pddl").write_text(generate(rng, True).text(f"p{i:02}", domain))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domains", nargs="+", default=list(CATALOGUE), choices=list(CATALOGUE), metavar="NAME")
    parser.add_argument("--noise", nargs="+", type=float, default=[0.0, 0.02, 0.05], help="flip rates, 0 to 1")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--told", action="store_true", help="do not select: the hidden predicates are known")
    parser.add_argument("--operators", help="the setting of that name: how operators are learned")
    parser.add_argument("--set", action="append", default=[], metavar="SETTING=VALUE", help="any learning setting")
    parser.add_argument("--unknown", type=float, default=0.0, help="share of candidate labels that are unknown")
    parser.add_argument("--sticky", action="store_true", help="an error stays until an action touches an object")
    parser.add_argument("--skill-args", choices=("all", "subset"), default="all", help="subset: as robot skills")
    parser.add_argument("--max-seconds", type=float, default=MAX_SECONDS, help="CPU seconds to solve one problem")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--verbose", action="store_true", help="one line per cell as it is done")
    parser.add_argument("--write", type=Path, metavar="DIR", help="write the traces files and stop")
    parser.add_argument("--pddl", type=Path, metavar="DIR", help="write larger problems as PDDL and stop")
    return parser


if __name__ == "__main__":
    main()
