"""What learning and solving cost under each protocol, in questions, atoms, tokens and dollars, and what is solved.

    python benchmarks/price.py --families combo --seeds 7 --flip 0.02 --json

The offline reader answers, some of its labels turned round (``--flip``), and every question is counted as if it had
been sent to ``--model``: text by characters, pictures by the provider's rule, dollars by the installed price list.
Learning and the first states of ``--count`` unseen tasks are counted together. ``chain`` is the largest number of
questions of which each needs the answer to the one before. With ``--json`` the last line is one object with the figures
by protocol.
"""

from __future__ import annotations

import argparse
import json
import threading
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from pix2pred.execution import Solver
from pix2pred.pipeline import LearningProblem, learn
from pix2pred.predicates import labeller_for
from pix2pred.registry import REGISTRY
from pix2pred.settings import Layer, resolve
from pix2pred.vlm import VLM, Answer, Purpose, Request
from pix2pred.vlm.control.estimate import EstimatingVLM
from pix2pred.vlm.noise.flips import FlippingVLM

PROTOCOLS: dict[str, dict[str, Any]] = {
    "published": {},
    "without-double-check": {"labels": {"double_check": False}},
    "frugal": {"labels": {"protocol": "frugal"}},
}
FAMILIES = {
    "more-stacks": "burger", "bigger": "burger", "combo": "burger", "boil": "kitchen", "three-cups": "coffee",
}  # fmt: skip
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


def run(
    protocol: str, family: str, seed: int, flip: float, count: int, model: str, given: Sequence[Layer]
) -> dict[str, Any]:
    """The figures of one family and seed."""
    name = FAMILIES[family]
    domain = REGISTRY.domain(name)
    settings = resolve(
        Layer({"learning": dict(domain.settings(family))}, "the domain"), Layer(PROTOCOLS[protocol], protocol), *given
    )
    reader = REGISTRY.vlm("offline", name)
    answering = FlippingVLM(reader, flip, seed) if flip else reader
    counting = EstimatingVLM(lambda counted: counted(Unstored(answering)), REGISTRY.model_spec(model).rates)
    chains = Chains(counting)
    learned = learn(LearningProblem(domain.vocabulary(family), domain.demonstrations(family, seed), chains, settings))
    longest = chains.longest
    labeller = labeller_for(chains, settings.labels)
    solver = Solver(learned.model, REGISTRY.planner("portfolio"), labeller, samplers=learned.samplers)
    tasks = domain.tasks(family, seed, count)
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


def summed(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The sums over ``rows``, and the longest chain of any."""
    total = {key: sum(row[key] for row in rows) for key in SUMMED}
    return total | {"dollars": round(total["dollars"], 4), "chain": max(row["chain"] for row in rows)}


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
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    rows = []
    learner = {"learning": {"operators": arguments.operators}}
    given = [Layer(learner, "--operators"), Layer(json.loads(arguments.config), "--config")]
    print("| protocol | family | seed | flipped | dollars | questions | atoms | tokens | chain | solved | selected |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for family in arguments.families:
        for seed in arguments.seeds:
            for flip in arguments.flip:
                for protocol in arguments.protocols:
                    row = run(protocol, family, seed, flip, arguments.count, arguments.model, given)
                    rows.append(row)
                    tokens = f"{row['input_tokens'] / 1e3:.0f}k + {row['output_tokens'] / 1e3:.0f}k"
                    print(
                        f"| {protocol} | {family} | {seed} | {flip:.0%} | {row['dollars']:.2f} | {row['questions']} | "
                        f"{row['atoms']} | {tokens} | {row['chain']} | {row['solved']} of {row['tasks']} | "
                        f"{', '.join(row['selected'])} |",
                        flush=True,
                    )
    result = {p: summed([r for r in rows if r["protocol"] == p]) for p in arguments.protocols}
    if arguments.json:
        print(json.dumps(result))
    else:
        for protocol, total in result.items():
            print(f"{protocol}: {total}")


if __name__ == "__main__":
    main()
