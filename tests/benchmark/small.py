"""A benchmark that takes seconds: three demonstrations of the real simulator and a model that answers by hash.

Also a program: ``python small.py FOLDER JOBS`` runs it, so that tests can kill it.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pix2pred.benchmark import Run, Suite, run_suite
from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger.demonstrator import demonstrate
from pix2pred.domains.burger.families import load_families
from pix2pred.domains.burger.scenes import initial_world
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.registry import Registry
from pix2pred.structs import Demo
from pix2pred.structs.environment import Domain, SimulatedTask
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.system.parallel import Workers
from pix2pred.vlm import VLM, Answer, Purpose, Request, StoreMode
from pix2pred.vlm.offline.prompt_format import asked_atoms, current_views, label_answer, value_line

ONE = Workers(1)


class SmallBurger(BurgerDomain):
    """Two demonstrations instead of twelve."""

    def demonstrations(self, family: str, seed: int) -> Sequence[Demo]:
        chosen = load_families()[family]
        demos = []
        for i, recipe in enumerate(chosen.demonstrations[1:3]):
            world = initial_world(recipe.scene, scene_generator(seed, Split.DEMONSTRATIONS, chosen.index, i))
            demos.append(demonstrate(f"{family}-{i}", chosen, recipe, world))
        return tuple(demos)

    def demonstration_starts(self, family: str, seed: int) -> Sequence[SimulatedTask]:
        chosen = load_families()[family]
        return tuple(
            self._task(f"{family}-{i}", chosen, recipe, Split.DEMONSTRATIONS, seed, i)
            for i, recipe in enumerate(chosen.demonstrations[1:3])
        )


@dataclass
class HashVLM:
    """Proposes two words and labels by the hash of picture and atom: always the same nonsense."""

    name: str = "hash"

    def answer(self, request: Request) -> Answer:
        if request.purpose == Purpose.PROPOSE:
            return Answer("cooked(patty1), empty_handed(robot), shiny(grill)")
        picture = current_views(request.views)[0].picture.image.digest
        lines = [
            value_line(atom, hashlib.sha256(f"{picture}{atom}".encode()).digest()[0] % 3 > 0, "By hash.")
            for atom in asked_atoms(request.text)
        ]
        return Answer(label_answer(request.text, lines))


class SmallNames(Registry):
    def domain(self, name: str) -> Domain:
        if name != "burger":
            raise UnknownNameError("domain", name, ["burger"])
        return SmallBurger()

    def vlm(self, spec: str, domain: str | None, *_: object, **__: object) -> VLM:
        return HashVLM("offline:hash" if spec == "offline" else spec)

    def writes(self, spec: str) -> bool:
        return spec != "offline"


def small_suite(**changes: Any) -> Suite:
    learning = {"max_plans": 2, "node_budget": 500}
    return Suite.model_validate(
        {
            "name": "small",
            "about": "a benchmark of seconds",
            "approaches": ["ours", "no-subselect", "no-invent", "vila-pure"],
            "families": [
                {"name": "stacks", "domain": "burger", "family": "more-stacks"},
                {"name": "kitchen", "domain": "kitchen"},
            ],
            "seeds": [0, 1],
            "tasks": 2,
            "settings": {"learning": learning, "grammar": {"max_candidates": 3}},
            "budgets": {"ground_operators": 2000, "optimal_nodes": 50, "nodes": 200},
            **changes,
        }
    )


def run_small(folder: Path, *, workers: Workers = ONE, names: Registry | None = None, **changes: Any) -> Run:
    answers, mode = changes.pop("answers", None), changes.pop("mode", StoreMode.RESUME)
    vlm, warn = changes.pop("vlm", "offline"), changes.pop("warn", print)
    suite = small_suite(**changes)
    return run_suite(
        folder, suite, names or SmallNames(), vlm=vlm, workers=workers, answers=answers, mode=mode, warn=warn
    )


if __name__ == "__main__":
    run_small(Path(sys.argv[1]), workers=Workers(int(sys.argv[2])))
