"""Learning and solving into a run folder, so that nothing is lost and everything can be resumed."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from pix2pred.execution import Solver, TruthOf
from pix2pred.execution.film import Film, FilmedEpisode
from pix2pred.learning import advice_document, advise, dump_traces, load_traces, selection_document
from pix2pred.learning.samplers.file import dump_samplers, load_samplers
from pix2pred.pipeline import Learned, Progress, Selected, Settings, learn, select
from pix2pred.planning.pddl.write import write_domain
from pix2pred.predicates import (
    CORRECTIONS,
    EVIDENCE,
    Corrections,
    EmptyProposalError,
    Occurrence,
    Proposal,
    dump_evidence,
    goal_warnings,
    load_corrections,
)
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.structs import (
    Demo,
    Episode,
    ExecutedStep,
    Failure,
    FromVLM,
    Label,
    LiftedAtom,
    Operator,
    Vocabulary,
    WorldModel,
)
from pix2pred.structs.environment import Environment, SimulatedTask
from pix2pred.structs.formats.world_model import dump_model, load_model
from pix2pred.structs.samplers import Sampler
from pix2pred.vlm import CountingVLM

MODEL = "model/world_model.json"
SAMPLERS = "model/samplers.npz"
AS_SAID = "labels/as_said.json"
"""The truth table as the model gave it; ``labels/traces.json`` is what is left of it after corrections."""
ADVICE = "labels/doubts.json"
"""Labels that are probably wrong, the most useful to check first."""
HISTORY = "history"
"""Selections by the number of corrections they were made with."""
_SHOWN_GAPS = 5


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
    stages = _Stages(progress, vlm)
    try:
        learned = learn(vocabulary, demos, vlm, settings, stages, corrections=corrections)
    except EmptyProposalError as error:
        run.write_json("proposals.json", [_proposal_doc(p) for p in error.proposals])
        raise
    table, gaps = learned.labelling.table, learned.labelling.gaps
    run.write_json("proposals.json", [_proposal_doc(p) for p in learned.proposals])
    run.write(AS_SAID, dump_traces(vocabulary, table, settings.learning.model_dump()))
    run.write(EVIDENCE, dump_evidence(demos, learned.labelling))
    run.write_json("labels/gaps.json", [asdict(gap) for gap in gaps])
    metrics = {
        "labels_from": vlm.name,
        "demonstrations": len(demos),
        "transitions": sum(len(d.actions) for d in demos),
        "proposed": sum(len(p.accepted) for p in learned.proposals),
        "rejected": sum(len(p.rejected) for p in learned.proposals),
        "label_problems": {k: v for k, v in sorted(learned.labelling.counts.items()) if v and k != Occurrence.READ},
        "labels": sum(d.values.size for d in table.demos),
        "labels_without_answer": sum(len(gap.atoms) for gap in gaps),
        "missing_answers": _gap_warnings(learned),
    }
    if learned.samplers:
        metrics["samplers"] = {}
    metrics = _write_selected(run, learned.selected, learned.samplers, settings, corrections, metrics, stages)
    timings = {
        "queries": vlm.usage.as_dict(),
        "demonstrations": vlm.usage.demos_dict(),
        "flow": settings.flow.model_dump(),
    }
    run.write_json("timings.json", stages.timings() | timings)
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
    samplers = load_samplers(run.path / SAMPLERS) if (run.path / SAMPLERS).exists() else {}
    corrections = load_corrections(run.path / CORRECTIONS)
    table = load_traces(run.path / AS_SAID).table
    stages = _Stages(progress)
    selected = select(model.vocabulary, table, settings.learning, model.labels_from, corrections, stages)
    kept = _kept_samplers(model, samplers, selected.model)
    return selected, _write_selected(run, selected, kept, settings, corrections, metrics, stages) | {
        "seconds": stages.seconds()
    }


def _write_selected(
    run: RunFolder,
    selected: Selected,
    samplers: Mapping[str, Sampler],
    settings: Settings,
    corrections: Corrections,
    metrics: Mapping[str, Any],
    stages: _Stages,
) -> dict[str, Any]:
    """Write what selection gave, and remember it among the results before; gives ``metrics`` brought up to date."""
    stages("doubt", 0, 1, "")
    model, table, selection = selected.model, selected.table, selected.selection
    document = selection_document(selection, settings.learning)
    run.write("labels/traces.json", dump_traces(model.vocabulary, table, settings.learning.model_dump()))
    run.write_json("selection.json", document)
    (run.path / SAMPLERS).unlink(missing_ok=True)  # samplers never lie beside a model they were not learned for
    run.write(MODEL, dump_model(model))
    run.write("model/domain.pddl", write_domain(model))
    if samplers:
        run.write_bytes(SAMPLERS, dump_samplers(samplers))
    version = {"version": 1, "corrections": corrections.count}
    run.write_json(f"{HISTORY}/{corrections.count:05d}.json", version | document)
    advice = advise(table, settings.learning, selection.pinned, selection.selected)
    run.write_json(ADVICE, advice_document(advice))
    warnings = [*goal_warnings(table.demos), *metrics.get("missing_answers", ())]
    lacking = [op.name for op in model.operators if op.skill.dimension and op.name not in samplers]
    if lacking and "samplers" in metrics:
        warnings.append(
            f"{', '.join(lacking)}: no sampler fits, so parameters are drawn uniformly; samplers need the pictures' "
            "features: run 'pix2pred learn DATA --out RUN' again, which asks nothing that was answered"
        )
    updated = dict(metrics) | {
        "corrections": corrections.count,
        "candidates": len(table.candidates()),
        "unknown_labels": table.count(Label.UNKNOWN),
        "warnings": warnings,
        "selected": [p.name for p in selection.selected],
        "operators": len(selection.operators),
        "J": [round(step.j, 4) for step in selection.steps],
        "budget_hits": selection.budget_hits,
    }
    if "samplers" in metrics:
        updated["samplers"] = {name: sampler.name for name, sampler in samplers.items()}
    stages("doubt", 1, 1, "")
    run.write_json("metrics.json", updated)
    return updated


def _kept_samplers(before: WorldModel, samplers: Mapping[str, Sampler], after: WorldModel) -> dict[str, Sampler]:
    """The samplers of operators that are in both models, whatever they and their predicates are called."""
    known = {_nameless(op): samplers[op.name] for op in before.operators if op.name in samplers}
    return {op.name: known[_nameless(op)] for op in after.operators if _nameless(op) in known}


def _nameless(operator: Operator) -> Operator:
    """``operator`` with the words that a model is asked with in place of the names people gave its predicates."""

    def atoms(lifted: frozenset[LiftedAtom]) -> frozenset[LiftedAtom]:
        return frozenset(
            replace(a, predicate=replace(a.predicate, name=f"asked {source.phrase}"))
            if isinstance(source := a.predicate.source, FromVLM)
            else a
            for a in lifted
        )

    return replace(
        operator,
        name="",
        preconditions=atoms(operator.preconditions),
        add=atoms(operator.add),
        delete=atoms(operator.delete),
        support=0,
    )


class _Stages:
    """Passes progress on, with what was asked of ``vlm``, and measures how long each stage takes."""

    def __init__(self, progress: Progress, vlm: CountingVLM | None = None) -> None:
        self._progress = progress
        self._vlm = vlm
        self._start = time.perf_counter()
        self._begun: dict[str, float] = {}
        self._latest = ("propose", 0, 1)
        if vlm is not None:
            vlm.on_answer = lambda: progress(*self._latest, vlm.usage.line())

    def __call__(self, stage: str, done: int, total: int, text: str) -> None:
        self._begun.setdefault(stage, time.perf_counter())
        self._latest = (stage, done, total)
        asks = stage in ("propose", "label")
        self._progress(stage, done, total, self._vlm.usage.line() if self._vlm and asks else text)

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


def _gap_warnings(learned: Learned) -> list[str]:
    """One line per demonstration without a whole proposal, and per state and reason for which labels are missing."""
    lines = [f"{p.demo}: proposal: {p.problem}" for p in learned.proposals if p.problem]
    gaps = learned.labelling.gaps
    lines += [f"{g.about}: {g.purpose}: no value for {len(g.atoms)} atoms ({g.reason})" for g in gaps[:_SHOWN_GAPS]]
    if len(gaps) > _SHOWN_GAPS:
        lines.append(f"and {len(gaps) - _SHOWN_GAPS} more such gaps; all are in labels/gaps.json")
    return lines


def _proposal_doc(proposal: Proposal) -> dict[str, Any]:
    return {
        "demo": proposal.demo,
        "accepted": [f"{a.name}({', '.join(o.name for o in a.objects)})" for a in proposal.accepted],
        "rejected": [{"text": r.text, "reason": r.reason} for r in proposal.rejected],
        **({"problem": proposal.problem} if proposal.problem else {}),
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
    film: Film | None = None,
) -> Solved:
    """Try every task once and write a file per episode, as soon as it ends; ``film`` records them all."""
    episodes = []
    for i, stored in enumerate(tasks):
        progress(i, len(tasks), stored.task.name)
        environment, truth = environment_for(stored)
        if film is None:
            episode = solver.solve(stored.task, environment, truth)
        else:
            filmed = FilmedEpisode(environment, film, stored.task.name)
            episode = solver.solve(stored.task, filmed, truth, filmed.announce)
            filmed.conclude(["goal reached"] if episode.solved else [f"failed: {episode.failure}", episode.detail])
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
        "steps": [_step_doc(step) for step in episode.steps],
        "true_visual_labels": [str(a) for a in episode.labels],
        "label_errors": list(episode.label_errors),
        "nodes": episode.nodes,
        "replans": episode.replans,
    }


def _step_doc(step: ExecutedStep) -> dict[str, Any]:
    doc = {
        "action": step.action,
        "operator": step.operator,
        "status": step.status,
        "detail": step.detail,
        "observed": None if step.observed is None else list(step.observed),
    }
    return doc | ({"sampler": step.sampler, "rejections": step.rejections} if step.sampler else {})
