"""What learning and solving cost under each protocol, in questions, atoms, tokens and dollars, and what is solved.

    python benchmarks/price.py --families combo --seeds 7 --flip 0.02 --json

The offline reader answers, some of its labels turned round (``--flip``), and every question is counted as if it had
been sent to ``--model``: text by characters, pictures by the provider's rule, dollars by the installed price list.
Learning and the first states of ``--count`` unseen tasks are counted together. ``chain`` is the largest number of
questions of which each needs the answer to the one before. With ``--json`` the last line is one object with the figures
by protocol. With ``--out FILE`` every run is a line of that file, and those that are in it are not repeated;
``--minutes`` begins no run after that time.
"""

from __future__ import annotations

import argparse
import json
import threading
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any

from pix2pred.execution import Solver
from pix2pred.pipeline import LearningProblem, learn
from pix2pred.predicates import labeller_for
from pix2pred.registry import REGISTRY
from pix2pred.settings import Layer, of_project, resolve
from pix2pred.structs import Demo
from pix2pred.structs.environment import Domain, SimulatedTask, asking_settings
from pix2pred.vlm import VLM, Answer, Purpose, Request
from pix2pred.vlm.control.estimate import EstimatingVLM
from pix2pred.vlm.noise.flips import FlippingVLM

Row = dict[str, Any]
PROTOCOLS: dict[str, dict[str, Any]] = {
    "published": {},
    "without-double-check": {"labels": {"double_check": False}},
    "frugal": {"labels": {"protocol": "frugal"}},
}
FAMILIES = {
    "more-stacks": ("burger", "more-stacks"), "bigger": ("burger", "bigger"), "combo": ("burger", "combo"),
    "boil": ("kitchen", "boil"), "three-cups": ("coffee", "three-cups"),
    "cleanup": ("cleanup", "new-objects"), "juice": ("juice", "new-objects"),
}  # fmt: skip
"""What is measured, as domain and family of tasks."""

IN_ORDER = (Purpose.LABEL, Purpose.DOUBLE_CHECK, Purpose.HISTORY)
SUMMED = (
    "dollars",
    "questions",
    "pictures",
    "atoms",
    "input_tokens",
    "cached_tokens",
    "output_tokens",
    "solved",
    "tasks",
)


@dataclass
class Chains:
    """Passes requests on and counts those that wait for one another."""

    model: VLM
    proposals: Counter[Purpose] = field(default_factory=Counter)
    labels: Counter[str] = field(default_factory=Counter)
    lock: threading.Lock = field(default_factory=threading.Lock)

    @property
    def name(self) -> str:
        return self.model.name

    def answer(self, request: Request) -> Answer:
        with self.lock:
            if request.purpose in IN_ORDER:
                self.labels[request.about.partition(",")[0]] += 1
            else:
                self.proposals[request.purpose] += 1
        return self.model.answer(request)

    @property
    def longest(self) -> int:
        """Proposals with definitions build on one another, others do not; labels do within a demonstration."""
        proposals = self.proposals[Purpose.DEFINE] + (self.proposals[Purpose.PROPOSE] > 0)
        return proposals + max(self.labels.values(), default=0)


class Unstored:
    """The reader in the place of an answer store: what it says is counted as asked."""

    def __init__(self, model: VLM) -> None:
        self.name = model.name
        self._model = model

    def answer(self, request: Request) -> Answer:
        return Answer(self._model.answer(request).text)


@lru_cache(maxsize=1)
def drawn(family: str, seed: int, count: int) -> tuple[Domain, tuple[Demo, ...], Sequence[SimulatedTask], VLM]:
    """What all runs of a family and seed share: demonstrations, tasks, and the reader with what it has read."""
    name, tasks_of = FAMILIES[family]
    domain = REGISTRY.domain(name)
    demos, tasks = tuple(domain.demonstrations(tasks_of, seed)), domain.tasks(tasks_of, seed, count)
    return domain, demos, tasks, REGISTRY.vlm("offline", name)


def run(protocol: str, family: str, seed: int, flip: float, count: int, given: Sequence[Layer], model: str) -> Row:
    """The figures of one family and seed."""
    tasks_of = FAMILIES[family][1]
    domain, demos, tasks, reader = drawn(family, seed, count)
    project = {"learning": dict(domain.settings(tasks_of)), **asking_settings(domain, tasks_of)}
    settings = resolve(of_project(project), Layer(PROTOCOLS[protocol], protocol), *given)
    answering = FlippingVLM(reader, flip, seed) if flip else reader
    counting = EstimatingVLM(lambda counted: counted(Unstored(answering)), REGISTRY.model_spec(model).rates)
    chains = Chains(counting)
    learned = learn(LearningProblem(domain.vocabulary(tasks_of), demos, chains, settings))
    longest = chains.longest
    labeller = labeller_for(chains, settings.labels)
    solver = Solver(learned.model, REGISTRY.planner("portfolio"), labeller, samplers=learned.samplers)
    solved = sum(solver.solve(t.task, domain.environment(t.task, t.simulator)).solved for t in tasks)
    spent = counting.as_dict()
    return {
        "protocol": protocol, "family": family, "seed": seed, "flip": flip,
        "dollars": spent["dollars"], "questions": spent["queries"], "pictures": spent["pictures"],
        "atoms": spent["atoms"], "input_tokens": spent["input_tokens"],
        "cached_tokens": spent["cached_tokens"], "output_tokens": spent["output_tokens"],
        "solved": solved, "tasks": len(tasks), "chain": longest,
        "selected": [p.name for p in learned.model.selected],
    }  # fmt: skip


def summed(rows: Sequence[Row]) -> Row:
    """The sums over ``rows``, and the longest chain of any."""
    total = {key: sum(row[key] for row in rows) for key in SUMMED}
    return total | {"dollars": round(total["dollars"], 4), "chain": max(row["chain"] for row in rows)}


def line(row: Row) -> str:
    """A row of the printed table."""
    tokens = f"{row['input_tokens'] / 1e3:.0f}k + {row['output_tokens'] / 1e3:.0f}k"
    return (
        f"| {row['protocol']} | {row['family']} | {row['seed']} | {row['flip']:.0%} | {row['dollars']:.2f} | "
        f"{row['questions']} | {row['atoms']} | {tokens} | {row['chain']} | {row['solved']} of {row['tasks']} | "
        f"{', '.join(row['selected'])} |"
    )


def shares(rows: Sequence[Row]) -> str:
    """Means per run by family and protocol, the share of the published dollars, and what was solved."""
    lines = [
        "| family | protocol | dollars | share | questions | atoms | tokens in + out | cached | chain | solved |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for family in dict.fromkeys(r["family"] for r in rows):
        published = [r["dollars"] for r in rows if r["family"] == family and r["protocol"] == "published"]
        for protocol in dict.fromkeys(r["protocol"] for r in rows):
            if not (mine := [r for r in rows if r["family"] == family and r["protocol"] == protocol]):
                continue
            total, n = summed(mine), len(mine)
            share = total["dollars"] / n / (sum(published) / len(published)) if published else float("nan")
            lines.append(
                f"| {family} | {protocol} | {total['dollars'] / n:.2f} | {share:.1%} | {total['questions'] / n:.0f} | "
                f"{total['atoms'] / n:,.0f} | {total['input_tokens'] / n / 1e3:.0f}k + "
                f"{total['output_tokens'] / n / 1e3:.0f}k | {total['cached_tokens'] / n / 1e3:.0f}k | "
                f"{total['chain']} | {total['solved']} of {total['tasks']} |"
            )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--families", nargs="*", default=list(FAMILIES), choices=list(FAMILIES))
    parser.add_argument("--seeds", nargs="*", type=int, default=list(range(5)))
    parser.add_argument("--flip", nargs="*", type=float, default=[0.0, 0.02])
    parser.add_argument("--protocols", nargs="*", default=list(PROTOCOLS), choices=list(PROTOCOLS))
    parser.add_argument("--count", type=int, default=10, help="tasks per family and seed")
    parser.add_argument("--model", default="openai:gpt-4o", help="whose prices are counted")
    parser.add_argument("--operators", default="robust", help="the learner, the same for every protocol")
    parser.add_argument("--config", default="{}", help="settings on top, as JSON")
    parser.add_argument("--out", type=Path, help="a file with a line per run; runs in it are not repeated")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="begin no run after that time")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    learner = {"learning": {"operators": arguments.operators}}
    given = [Layer(learner, "--operators"), Layer(json.loads(arguments.config), "--config")]
    kept: Path | None = arguments.out
    done = [json.loads(text) for text in kept.read_text().splitlines()] if kept and kept.exists() else []
    rows, begun = [], time.monotonic()
    print("| protocol | family | seed | flipped | dollars | questions | atoms | tokens | chain | solved | selected |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for family, seed, flip, protocol in product(
        arguments.families, arguments.seeds, arguments.flip, arguments.protocols
    ):
        wanted = {"protocol": protocol, "family": family, "seed": seed, "flip": flip}
        row = next((r for r in done if wanted.items() <= r.items()), None)
        if row is None:
            if time.monotonic() - begun > 60 * arguments.minutes:
                return
            row = run(protocol, family, seed, flip, arguments.count, given, arguments.model)
            if kept:
                with kept.open("a") as stream:
                    stream.write(json.dumps(row) + "\n")
        rows.append(row)
        print(line(row), flush=True)
    print(shares(rows))
    result = {p: summed([r for r in rows if r["protocol"] == p]) for p in arguments.protocols}
    if arguments.json:
        print(json.dumps(result))
    else:
        for protocol, total in result.items():
            print(f"{protocol}: {total}")


if __name__ == "__main__":
    main()
