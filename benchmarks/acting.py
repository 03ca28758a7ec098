"""Acting on labels that are sometimes wrong: tasks solved, and what that costs.

    python benchmarks/acting.py --domain burger --family combo --seed 7 --kind sticky-picture --rate 0.05 --disturb 0 \
        --count 10 --json

A model is learned from the demonstrations of the seed, labelled by the offline reader with 2 % of the labels flipped
(--train-rate); it is kept in OUT and used again. Then the tasks of the seed are tried with labels that err as --kind
and --rate say. The last line is one object with ``solved``, ``tasks``, ``questions`` (asked of the model), ``atoms``
(values asked for), ``skills`` (executed in solved tasks), ``again`` (atoms asked about again), ``suspected`` (episodes
that end with a suspect) and ``named`` (those whose suspect is the systematic error). --how: ``belief`` is what
``solve --closed-loop`` does, ``replan`` believes every label (FF-Replan), ``votes`` takes the majority of three samples
for every atom, ``open`` looks once and asks again, ``open-raw`` looks once. --truth: in the place of the reader the
simulator labels demonstrations and looks, with the same errors; for domains whose reader is not good enough.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from perfect_labels import Truthful, learned_from_truth
from pix2pred.execution import Solver
from pix2pred.execution.belief.perception import AtTheirWord, Believing
from pix2pred.learning.samplers.file import dump_samplers, load_samplers
from pix2pred.pipeline import LearningProblem, learn
from pix2pred.predicates import Labeller, LabelSettings
from pix2pred.registry import load_domain, load_planner, load_vlm
from pix2pred.settings import of_project, resolve
from pix2pred.structs import Episode, FromVLM, State, WorldModel
from pix2pred.structs.environment import Domain, SimulatedTask, asking_settings
from pix2pred.structs.formats.world_model import dump_model, load_model
from pix2pred.structs.samplers import Sampler
from pix2pred.vlm import VLM, Answer, Request
from pix2pred.vlm.noise.errors import ErringVLM, Errors, Hidden, PerPicture, PerQuestion, Systematic, UntilTouched
from pix2pred.vlm.noise.flips import FlippingVLM
from pix2pred.vlm.offline.prompt_format import asked_atoms
from seen_before import History, Redrawn, Reread

KINDS = ("independent", "sticky-picture", "sticky-object", "systematic", "unknown")
WAYS = ("belief", "replan", "votes", "open", "open-raw")


@dataclass
class Counting:
    """Counts questions and the atoms in them."""

    model: VLM
    count: Counter[str] = field(default_factory=Counter)

    @property
    def name(self) -> str:
        return self.model.name

    def answer(self, request: Request) -> Answer:
        self.count["questions"] += 1
        self.count["atoms"] += sum(1 for _ in asked_atoms(request.text))
        return self.model.answer(request)


def learned(
    domain: Domain, family: str, seed: int, rate: float, operators: str, out: Path
) -> tuple[WorldModel, dict[str, Sampler]]:
    """The model of a seed, learned once."""
    folder = out / f"{domain.name}-{family}-{seed}-{rate:g}-{operators}"
    if not (folder / "model.json").exists():
        learning = {**domain.settings(family), "operators": operators}
        settings = resolve(of_project({"learning": learning, **asking_settings(domain, family)}))
        vlm = FlippingVLM(load_vlm("offline", domain.name), rate, seed)
        demos = tuple(domain.demonstrations(family, seed))
        result = learn(LearningProblem(domain.vocabulary(family), demos, vlm, settings))
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "samplers.json").write_bytes(dump_samplers(result.samplers))
        (folder / "model.json").write_text(dump_model(result.model))
    return load_model(folder / "model.json"), dict(load_samplers(folder / "samplers.json"))


def errors_of(kind: str, rate: float, seed: int, model: WorldModel, task: SimulatedTask) -> Errors:
    """The errors asked for; systematic ones are of one needed visual predicate and one object of the task."""
    number = seed * 1000 + int(task.task.name.rsplit("-", 1)[-1]) if task.task.name[-1].isdigit() else seed
    if kind == "systematic":
        needed = {a.predicate for op in model.operators for a in op.preconditions}
        visual = sorted(p for p in model.selected if p in needed and isinstance(p.source, FromVLM))
        predicate = visual[number % len(visual)]
        things = sorted(o for o in task.task.objects if o.type.is_a(predicate.types[0]))
        assert isinstance(predicate.source, FromVLM)
        return Systematic(1.0, number, predicate.source.phrase, things[number // len(visual) % len(things)].prompt_name)
    made: dict[str, Callable[[float, int], Errors]] = {
        "independent": PerQuestion, "sticky-picture": PerPicture, "sticky-object": UntilTouched, "unknown": Hidden,
    }  # fmt: skip
    return made[kind](rate, number)


def names_the_error(episode: Episode, errors: Errors | None) -> bool:
    """Whether a suspect of the episode is an atom that was always misread."""
    return isinstance(errors, Systematic) and any(
        isinstance(a.predicate.source, FromVLM)
        and a.predicate.source.phrase == errors.word
        and any(o.prompt_name.startswith(errors.kind) for o in a.objects)
        for a in episode.suspects
    )


@dataclass
class Ground:
    """What all conditions of one seed have in common: the model learned, the tasks, and what was drawn and read."""

    domain: Domain
    model: WorldModel
    samplers: dict[str, Sampler]
    tasks: Sequence[SimulatedTask]
    reader: VLM
    seen: dict[History, State] = field(default_factory=dict)

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> Ground:
        domain = load_domain(arguments.domain)
        which = (domain, arguments.family, arguments.seed, arguments.train_rate, arguments.operators, arguments.out)
        model, samplers = (learned_from_truth(*which), {}) if arguments.truth else learned(*which)
        tasks = domain.tasks(arguments.family, arguments.seed, arguments.count)
        return cls(domain, model, samplers, tasks, Reread(load_vlm("offline", domain.name)))

    def environment(self, task: SimulatedTask, disturb: float) -> Redrawn:
        """A fresh episode; states that an earlier one with the same skills came to are not drawn again."""
        environment = self.domain.environment(task.task, task.simulator, disturb)
        return Redrawn(environment, self.seen, (task.task.name, disturb))


def episodes(arguments: argparse.Namespace, ground: Ground) -> tuple[list[Episode], Counter[str]]:
    """The tasks tried, and counts: of questions and atoms, and of episodes whose suspect is the systematic error."""
    domain, model = ground.domain, ground.model
    count = Counter[str]()
    settings = LabelSettings(votes=3 if arguments.how == "votes" else 1)
    perceiving = {"belief": Believing(arguments.ask_again), "open": Believing(arguments.ask_again)}
    found, named = [], 0
    for task in ground.tasks:
        errors: Errors | None = None
        if arguments.rate or arguments.kind == "systematic":
            errors = errors_of(arguments.kind, arguments.rate, arguments.seed, model, task)
        environment = ground.environment(task, arguments.disturb)
        answering = Truthful.about(domain, environment.environment, task, model) if arguments.truth else ground.reader
        vlm: VLM = Counting(answering, count)
        vlm = ErringVLM(vlm, errors) if errors else vlm
        solver = Solver(
            model, load_planner("portfolio"), Labeller(vlm, settings), arguments.how not in ("open", "open-raw"),
            samplers=ground.samplers, perceiving=perceiving.get(arguments.how, AtTheirWord),
        )  # fmt: skip
        found.append(solver.solve(task.task, environment))
        named += names_the_error(found[-1], errors)
    return found, count + Counter(named=named)


def summary(found: list[Episode], count: Counter[str]) -> dict[str, Any]:
    return {
        "solved": sum(e.solved for e in found),
        "tasks": len(found),
        "questions": count["questions"],
        "atoms": count["atoms"],
        "skills": sum(len(e.steps) for e in found if e.solved),
        "again": sum(len(e.questions) for e in found),
        "suspected": sum(bool(e.suspects) for e in found),
        "named": count["named"],
        "failures": dict(Counter(str(e.failure) for e in found if not e.solved)),
    }


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--domain", default="burger")
    made.add_argument("--family", default="combo")
    made.add_argument("--seed", type=int, default=0)
    made.add_argument("--kind", choices=KINDS, default="sticky-picture")
    made.add_argument("--rate", type=float, default=0.05)
    made.add_argument("--disturb", type=float, default=0.0)
    made.add_argument("--count", type=int, default=10)
    made.add_argument("--how", choices=WAYS, default="belief")
    made.add_argument("--ask-again", type=int, default=4)
    made.add_argument("--train-rate", type=float, default=0.02)
    made.add_argument("--operators", choices=("robust", "cluster-and-intersect"), default="robust")
    made.add_argument("--truth", action="store_true", help="labels come from the simulator, errors aside")
    made.add_argument("--out", type=Path, default=Path("runs/acting"))
    made.add_argument("--json", action="store_true", help="print nothing but the last line")
    return made


def main() -> None:
    arguments = parser().parse_args()
    start = time.process_time()
    found, count = episodes(arguments, Ground.of(arguments))
    if not arguments.json:
        for e in found:
            print(f"{e.task}: {e.failure or 'solved'} {e.detail}; {len(e.steps)} skills, {e.replans} new plans")
            for q in e.questions:
                print(f"    {q.state} {q.atom} {q.why}: {q.answers} {q.before} -> {q.after}")
            for atom in e.suspects:
                print(f"    suspect: {atom}")
        print(f"{time.process_time() - start:.1f} CPU s")
    print(json.dumps(summary(found, count)))


if __name__ == "__main__":
    main()
