"""Learning and solving into a run folder, so that nothing is lost and everything can be resumed."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pix2pred.execution import Solver, TruthOf
from pix2pred.learning import advice_document, advise, dump_traces, load_traces, selection_document
from pix2pred.pipeline import Learned, Progress, Selected, Settings, learn, select
from pix2pred.planning.pddl_write import write_domain
from pix2pred.predicates import (
    CORRECTIONS,
    EVIDENCE,
    READ,
    Corrections,
    EmptyProposalError,
    Proposal,
    dump_evidence,
    goal_warnings,
    load_corrections,
)
from pix2pred.run_folder import RunFolder, RunFolderError
from pix2pred.structs import UNKNOWN, Demo, Episode, Failure, Vocabulary
from pix2pred.structs.environment import Environment, SimulatedTask
from pix2pred.structs.model_file import dump_model, load_model
from pix2pred.vlm import CountingVLM

MODEL = "model/world_model.json"
AS_SAID = "labels/as_said.json"
"""The truth table as the model gave it; ``labels/traces.json`` is what is left of it after corrections."""
ADVICE = "labels/doubts.json"
"""Labels that are probably wrong, the most useful to check first."""
HISTORY = "history"
"""Selections by the number of corrections they were made with."""


def learn_into(
    run: RunFolder,
    vocabulary: Vocabulary,
    demos: Sequence[Demo],
    vlm: CountingVLM,
    settings: Settings,
    progress: Progress,
) -> tuple[Learned, dict[str, Any]]:
    """Learn a world model and write every artefact; gives the model and the summary that ``metrics.json`` holds.

    Corrections that the folder holds are applied to what the model said.
    """
    corrections = load_corrections(run.path / CORRECTIONS)
    stages = _Stages(progress)
    try:
        learned = learn(vocabulary, demos, vlm, settings, stages, corrections)
    except EmptyProposalError as error:
        run.write_json("proposals.json", [_proposal_doc(p) for p in error.proposals])
        raise
    table = learned.labelling.table
    run.write_json("proposals.json", [_proposal_doc(p) for p in learned.proposals])
    run.write(AS_SAID, dump_traces(vocabulary, table, settings.learning.model_dump()))
    run.write(EVIDENCE, dump_evidence(demos, learned.labelling))
    metrics = {
        "labels_from": vlm.name,
        "demonstrations": len(demos),
        "transitions": sum(len(d.actions) for d in demos),
        "proposed": sum(len(p.accepted) for p in learned.proposals),
        "rejected": sum(len(p.rejected) for p in learned.proposals),
        "label_problems": dict(sorted((k, v) for k, v in learned.labelling.counts.items() if v and k != READ)),
        "labels": sum(d.values.size for d in table.demos),
    }
    stages("doubt", 0, 1, "")
    metrics |= _write_selected(run, vocabulary, learned.selected, settings, corrections)
    stages("doubt", 1, 1, "")
    run.write_json("metrics.json", metrics)
    run.write_json("timings.json", stages.timings() | {"queries": vlm.usage.as_dict()})
    return learned, metrics | {"seconds": stages.seconds()}


def relearn(run: RunFolder, progress: Progress) -> tuple[Selected, dict[str, Any]]:
    """Select and learn again in a finished run, from what the model said and the corrections made since.

    Asks no model and reads no picture. Raises ``RunFolderError`` when the run was never finished.
    """
    for name in (AS_SAID, MODEL, "metrics.json"):
        if not (run.path / name).exists():
            raise RunFolderError(
                f"{run.path / name}: is missing, so there is nothing to learn again from; "
                "finish the run first with 'pix2pred learn DATA --out RUN'"
            )
    config = run.config()
    try:
        settings = Settings.model_validate(config["settings"])
        metrics = json.loads((run.path / "metrics.json").read_text(encoding="utf-8"))
    except (KeyError, ValueError) as error:
        raise RunFolderError(f"{run.path}: is damaged ({type(error).__name__}: {error})") from error
    model = load_model(run.path / MODEL)
    corrections = load_corrections(run.path / CORRECTIONS)
    table = load_traces(run.path / AS_SAID).table
    stages = _Stages(progress)
    selected = select(model.vocabulary, table, settings.learning, model.labels_from, corrections, stages)
    stages("doubt", 0, 1, "")
    metrics |= _write_selected(run, model.vocabulary, selected, settings, corrections)
    stages("doubt", 1, 1, "")
    run.write_json("metrics.json", metrics)
    return selected, metrics | {"seconds": stages.seconds()}


def _write_selected(
    run: RunFolder, vocabulary: Vocabulary, selected: Selected, settings: Settings, corrections: Corrections
) -> dict[str, Any]:
    """Write what selection gave, and remember it among the results before; gives its part of the summary."""
    table, selection = selected.table, selected.selection
    document = selection_document(selection, settings.learning)
    run.write("labels/traces.json", dump_traces(vocabulary, table, settings.learning.model_dump()))
    run.write_json("selection.json", document)
    run.write(MODEL, dump_model(selected.model))
    run.write("model/domain.pddl", write_domain(selected.model))
    version = {"version": 1, "corrections": corrections.count}
    run.write_json(f"{HISTORY}/{corrections.count:05d}.json", version | document)
    advice = advise(table, settings.learning, selection.pinned, selection.selected)
    run.write_json(ADVICE, advice_document(advice))
    return {
        "corrections": corrections.count,
        "candidates": len(table.candidates()),
        "unknown_labels": table.count(UNKNOWN),
        "warnings": goal_warnings(table.demos),
        "selected": [p.name for p in selection.selected],
        "operators": len(selection.operators),
        "J": [round(step.j, 4) for step in selection.steps],
        "budget_hits": selection.budget_hits,
    }


class _Stages:
    """Passes progress on and measures how long each stage takes."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._start = time.perf_counter()
        self._begun: dict[str, float] = {}

    def __call__(self, stage: str, done: int, total: int, text: str) -> None:
        self._begun.setdefault(stage, time.perf_counter())
        self._progress(stage, done, total, text)

    def seconds(self) -> float:
        return round(time.perf_counter() - self._start, 3)

    def timings(self) -> dict[str, Any]:
        """Seconds in total and by stage; the last stage ends now."""
        seconds = self.seconds()
        stages = sorted(self._begun.items(), key=lambda item: item[1])
        ends = [*(t for _, t in stages[1:]), self._start + seconds]
        return {
            "seconds": seconds,
            "stages": {name: round(end - begin, 3) for (name, begin), end in zip(stages, ends, strict=True)},
        }


def _proposal_doc(proposal: Proposal) -> dict[str, Any]:
    return {
        "demo": proposal.demo,
        "accepted": [f"{a.name}({', '.join(o.name for o in a.objects)})" for a in proposal.accepted],
        "rejected": [{"text": r.text, "reason": r.reason} for r in proposal.rejected],
    }


@dataclass(frozen=True, slots=True)
class Solved:
    """All episodes of one set of tasks."""

    episodes: tuple[Episode, ...]

    def as_dict(self) -> dict[str, Any]:
        """Counts, failures by cause, and a row per episode."""
        failures = Counter(e.failure.value for e in self.episodes if e.failure)
        return {
            "solved": sum(e.solved for e in self.episodes),
            "tasks": len(self.episodes),
            "failures": {cause.value: failures[cause.value] for cause in Failure if failures[cause.value]},
            "episodes": [episode_doc(e) for e in self.episodes],
        }


EnvironmentFor = Callable[[SimulatedTask], tuple[Environment, TruthOf | None]]
"""A fresh episode of a task, and what is known of the truth in it."""


def solve_into(
    run: RunFolder,
    name: str,
    tasks: Sequence[SimulatedTask],
    solver: Solver,
    environment_for: EnvironmentFor,
    progress: Callable[[int, int, str], None],
) -> Solved:
    """Try every task once and write a file per episode, as soon as it ends."""
    episodes = []
    for i, stored in enumerate(tasks):
        progress(i, len(tasks), stored.task.name)
        environment, truth = environment_for(stored)
        episode = solver.solve(stored.task, environment, truth)
        run.write_json(f"solve/{name}/{stored.task.name}.json", episode_doc(episode))
        episodes.append(episode)
    progress(len(tasks), len(tasks), "")
    solved = Solved(tuple(episodes))
    run.write_json(f"solve/{name}/summary.json", solved.as_dict())
    return solved


def episode_doc(episode: Episode) -> Mapping[str, Any]:
    """An episode as written in files."""
    return {
        "task": episode.task,
        "solved": episode.solved,
        "failure": episode.failure.value if episode.failure else None,
        "detail": episode.detail,
        "plan": list(episode.plan),
        "steps": [
            {
                "action": s.action,
                "operator": s.operator,
                "status": s.status,
                "detail": s.detail,
                "observed": None if s.observed is None else list(s.observed),
            }
            for s in episode.steps
        ],
        "true_visual_labels": [str(a) for a in episode.labels],
        "label_errors": list(episode.label_errors),
        "nodes": episode.nodes,
        "replans": episode.replans,
    }
