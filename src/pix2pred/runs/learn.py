"""Learning into a run folder, stage by stage: what a stage gave is on disk before the next one begins."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pix2pred.demos import Project, project_digest
from pix2pred.learning import load_traces
from pix2pred.learning.samplers.file import load_samplers
from pix2pred.pipeline import Gathered, Learned, LearningProblem, Selected, advice, ask, fit_samplers, select
from pix2pred.predicates import EmptyProposalError, load_corrections
from pix2pred.runs import addresses
from pix2pred.runs.clock import StageClock
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.runs.layout import AS_SAID, CORRECTIONS, METRICS, MODEL, SAMPLERS, TIMINGS
from pix2pred.runs.metrics import asked_metrics, selected_metrics
from pix2pred.runs.save import save_asked, save_proposals, save_selected
from pix2pred.settings import Settings
from pix2pred.structs import FromVLM, Image, LiftedAtom, Operator, WorldModel
from pix2pred.structs.formats.world_model import load_model
from pix2pred.structs.samplers import Sampler
from pix2pred.system.files import read_regular, write_whole
from pix2pred.system.progress import Progress, silent
from pix2pred.vlm import AnswerStore, CountingVLM


@dataclass(frozen=True, slots=True)
class LearnedRun:
    """What a run folder now holds: the selection, ``metrics.json`` with the seconds it took, and what was asked."""

    selected: Selected
    metrics: dict[str, Any]
    usage: str = ""


def learn_into(run: RunFolder, problem: LearningProblem) -> LearnedRun:
    """Learn a world model and write every artefact. Corrections that the folder holds are applied to what was said.

    Raises what ``pipeline.learn`` raises; what was learned until then is in the folder.
    """
    corrections = load_corrections(run.path / CORRECTIONS)
    vlm = CountingVLM(problem.vlm)
    clock = StageClock(problem.progress, vlm, _fewest_questions(problem))
    problem = replace(problem, vlm=vlm, progress=clock)
    try:
        asked = ask(problem)
    except EmptyProposalError as error:
        save_proposals(run, error.proposals)
        raise
    save_asked(run, problem, asked)
    said, settings = asked.labelling.table, problem.settings.learning
    selected = select(problem.vocabulary, said, settings, vlm.name, corrections, clock)
    samplers = fit_samplers(problem, selected)
    metrics = _save_rest(run, problem, asked, selected, samplers, corrections.count)
    asking = {
        "queries": vlm.usage.as_dict(),
        "demonstrations": vlm.usage.demos_dict(),
        "flow": problem.settings.flow.model_dump(),
    }
    run.write_json(TIMINGS, clock.timings() | asking)
    return LearnedRun(selected, metrics | {"seconds": clock.seconds()}, vlm.usage.line())


def _save_rest(
    run: RunFolder,
    problem: LearningProblem,
    asked: Gathered,
    selected: Selected,
    samplers: Mapping[str, Sampler],
    corrections: int,
) -> dict[str, Any]:
    """Write everything but what was asked; gives the metrics."""
    settings = problem.settings.learning
    save_selected(run, selected, samplers, advice(selected, settings, problem.progress), settings, corrections)
    metrics = asked_metrics(problem, asked) | ({"samplers": {}} if samplers else {})
    metrics = selected_metrics(metrics, selected, samplers, corrections, settings)
    run.write_json(METRICS, metrics)
    return metrics


def save_learned(run: RunFolder, problem: LearningProblem, learned: Learned, spec: str) -> None:
    """Write what was learned in memory as a finished run, with the pictures of its demonstrations.

    ``spec`` is the name by which the model was asked for; empty when it has none. Raises ``RunFolderError`` for a
    folder that holds another run.
    """
    asked = Gathered(learned.proposals, learned.labelling)
    run.claim(run_config(problem, project_digest(_project(problem)), spec or problem.vlm.name, run.path))
    store = AnswerStore(run.path)
    for picture in (p for demo in problem.demos for state in demo.states for p in state.pictures):
        write_whole(store.blob(picture.image.digest), Image.from_pixels(picture.image.pixels()).encoded)
    save_asked(run, problem, asked)
    _save_rest(run, problem, asked, learned.selected, learned.samplers, 0)


def run_config(
    problem: LearningProblem,
    digest: str,
    spec: str,
    run: Path,
    simulator: Mapping[str, Any] | None = None,
    answers: Path | None = None,
) -> dict[str, Any]:
    """What ``config.yaml`` of the run folder ``run`` holds: all that its results depend on."""
    return {
        "data": digest,
        "vlm": addresses.kept(spec, run),
        "model": problem.vlm.name,
        "simulator": dict(simulator or {}),
        "settings": problem.settings.model_dump(mode="json", exclude={"flow"}),  # how to ask changes no result
        "answers": str(answers.resolve()) if answers else None,
    }


def _project(problem: LearningProblem) -> Project:
    return Project(problem.vocabulary, tuple(problem.demos), {}, None)


def _fewest_questions(problem: LearningProblem) -> int:
    """Questions about labels if every answer can be used and every list of atoms fits into one."""
    labels = problem.settings.labels
    states = sum(len(demo.states) for demo in problem.demos)
    return (states + (states - len(problem.demos) if labels.double_check else 0)) * labels.votes


def relearn(run: RunFolder, progress: Progress = silent) -> LearnedRun:
    """Select and learn again in a finished run, from what the model said and the corrections made since.

    Asks no model and reads no picture. Raises ``RunFolderError`` when the run was never finished.
    """
    for name in (AS_SAID, MODEL, METRICS):
        if not (run.path / name).exists():
            raise RunFolderError(
                f"{run.path / name}: is missing, so there is nothing to learn again from; "
                "finish the run first with 'pix2pred learn DATA --out RUN'"
            )
    config = run.config()
    try:
        settings = Settings.model_validate(config["settings"]).learning
        metrics = json.loads(read_regular(run.path / METRICS))
    except (KeyError, ValueError) as error:
        raise RunFolderError(f"{run.path}: is damaged ({type(error).__name__}: {error})") from error
    model = load_model(run.path / MODEL)
    samplers = load_samplers(run.path / SAMPLERS) if (run.path / SAMPLERS).exists() else {}
    corrections = load_corrections(run.path / CORRECTIONS)
    said = load_traces(run.path / AS_SAID).table
    clock = StageClock(progress)
    selected = select(model.vocabulary, said, settings, model.labels_from, corrections, clock)
    kept = _kept_samplers(model, samplers, selected.model)
    save_selected(run, selected, kept, advice(selected, settings, clock), settings, corrections.count)
    metrics = selected_metrics(metrics, selected, kept, corrections.count, settings)
    run.write_json(METRICS, metrics)
    return LearnedRun(selected, metrics | {"seconds": clock.seconds()})


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
