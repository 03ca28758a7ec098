"""Labels from the simulator itself, for benchmarks of what follows labelling: in demonstrations and at test time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pix2pred.execution.explaining.replayed_demos import truths_of_demos
from pix2pred.pipeline import LearningProblem, ask, climb, world_model
from pix2pred.predicates import ground_atoms
from pix2pred.predicates.prompt import atom_text
from pix2pred.registry import REGISTRY, load_vlm
from pix2pred.settings import of_project, resolve
from pix2pred.structs import Atom, FromVLM, Label, TruthTable, WorldModel
from pix2pred.structs.environment import Domain, Environment, Replayable, SimulatedTask, asking_settings
from pix2pred.structs.formats.world_model import dump_model, load_model
from pix2pred.vlm import Answer, Request
from pix2pred.vlm.offline.prompt_format import asked_atoms, label_answer, value_line


def learned_from_truth(domain: Domain, family: str, seed: int, rate: float, operators: str, out: Path) -> WorldModel:
    """The model of a seed when a share ``rate`` of the labels with a known truth is wrong; learned once.

    Words without a truth, the distractors, keep the labels of the reader.
    """
    path = out / f"{domain.name}-{family}-{seed}-truth-{rate:g}-{operators}.json"
    if not path.exists():
        learning = {**domain.settings(family), "operators": operators}
        settings = resolve(of_project({"learning": learning, **asking_settings(domain, family)}))
        vocabulary, demos = domain.vocabulary(family), tuple(domain.demonstrations(family, seed))
        said = ask(LearningProblem(vocabulary, demos, load_vlm("offline", domain.name), settings)).labelling.table
        assert isinstance(domain, Replayable), "the states of its demonstrations can be visited again"
        truth = truths_of_demos(
            demos,
            domain.demonstration_starts(family, seed),
            lambda start: domain.environment(start.task, start.simulator),
            lambda environment: REGISTRY.truth(domain, environment),
            [*(c.predicate for c in said.pool), *vocabulary.initial],
        )
        rng, labelled = np.random.default_rng(seed), []
        for d, demo in enumerate(said.demos):
            values = demo.values.copy()
            for i, atom in enumerate(demo.atoms):
                for t in range(len(values)):
                    known = truth(d, t, atom)
                    if known is not None:
                        values[t, i] = Label.of(known != (rng.random() < rate))
            labelled.append(replace(demo, values=values))
        table = TruthTable(said.initial, said.pool, tuple(labelled))
        model = world_model(vocabulary, table, climb(table, settings.learning), "the simulator")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dump_model(model))
    return load_model(path)


@dataclass
class Truthful:
    """Answers what holds in an environment now: nothing may happen between a look and its questions."""

    domain: Domain
    environment: Environment
    atoms: Mapping[str, Atom]
    name: str = "the simulator"

    @classmethod
    def about(cls, domain: Domain, environment: Environment, task: SimulatedTask, model: WorldModel) -> Truthful:
        """For the predicates of ``model`` and the objects of ``task``."""
        visual = [p for p in model.predicates if isinstance(p.source, FromVLM)]
        return cls(domain, environment, {atom_text(a): a for a in ground_atoms(visual, task.task.objects)})

    def answer(self, request: Request) -> Answer:
        truth = REGISTRY.truth(self.domain, self.environment)
        assert truth is not None, "the domain knows the truth of its reader's words"
        lines = [value_line(a, truth(self.atoms[str(a)]), "So it is.") for a in asked_atoms(request.text)]
        return Answer(label_answer(request.text, lines))
