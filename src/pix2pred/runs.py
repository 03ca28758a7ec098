"""Learning and solving into a run folder, so that nothing is lost and everything can be resumed."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from pix2pred.execution import Solver, TruthOf
from pix2pred.film import Film, FilmedEpisode
from pix2pred.learning import dump_traces, selection_document
from pix2pred.learning.samplers_file import dump_samplers
from pix2pred.pipeline import Learned, Progress, Settings, learn
from pix2pred.planning.pddl_write import write_domain
from pix2pred.predicates import READ, EmptyProposalError, Proposal, goal_warnings
from pix2pred.run_folder import RunFolder
from pix2pred.structs import UNKNOWN, Demo, Episode, ExecutedStep, Failure, Vocabulary
from pix2pred.structs.environment import Environment, SimulatedTask
from pix2pred.structs.model_file import dump_model
from pix2pred.vlm import CountingVLM

MODEL = "model/world_model.json"
SAMPLERS = "model/samplers.npz"
_SHOWN_GAPS = 5


def learn_into(
    run: RunFolder,
    vocabulary: Vocabulary,
    demos: Sequence[Demo],
    vlm: CountingVLM,
    settings: Settings,
    progress: Progress,
) -> tuple[Learned, dict[str, Any]]:
    """Learn a world model and write every artefact; gives the model and the summary that ``metrics.json`` holds."""
    started: dict[str, float] = {}
    start = time.perf_counter()

    latest: tuple[str, int, int] = ("propose", 0, len(demos))

    def timed(stage: str, done: int, total: int, text: str) -> None:
        nonlocal latest
        started.setdefault(stage, time.perf_counter())
        latest = (stage, done, total)
        progress(stage, done, total, text if stage == "select" else vlm.usage.line())

    vlm.on_answer = lambda: progress(*latest, vlm.usage.line())
    try:
        learned = learn(vocabulary, demos, vlm, settings, timed)
    except EmptyProposalError as error:
        run.write_json("proposals.json", [_proposal_doc(p) for p in error.proposals])
        raise
    seconds = time.perf_counter() - start
    table, selection = learned.labelling.table, learned.selection
    run.write_json("proposals.json", [_proposal_doc(p) for p in learned.proposals])
    run.write("labels/traces.json", dump_traces(vocabulary, table, settings.learning.model_dump()))
    run.write_json("labels/gaps.json", [asdict(gap) for gap in learned.labelling.gaps])
    run.write_json("selection.json", selection_document(selection, settings.learning))
    run.write(MODEL, dump_model(learned.model))
    if learned.samplers:
        run.write_bytes(SAMPLERS, dump_samplers(learned.samplers))
    run.write("model/domain.pddl", write_domain(learned.model))
    metrics = {
        "labels_from": learned.model.labels_from,
        "demonstrations": len(demos),
        "transitions": sum(len(d.actions) for d in demos),
        "proposed": sum(len(p.accepted) for p in learned.proposals),
        "rejected": sum(len(p.rejected) for p in learned.proposals),
        "candidates": len(table.candidates()),
        "labels": sum(d.values.size for d in table.demos),
        "unknown_labels": table.count(UNKNOWN),
        "label_problems": dict(sorted((k, v) for k, v in learned.labelling.counts.items() if v and k != READ)),
        "labels_without_answer": sum(len(gap.atoms) for gap in learned.labelling.gaps),
        "warnings": goal_warnings(table.demos) + _gap_warnings(learned),
        "selected": [p.name for p in selection.selected],
        "operators": len(selection.operators),
        "J": [round(step.j, 4) for step in selection.steps],
        "budget_hits": selection.budget_hits,
    }
    if learned.samplers:
        metrics["samplers"] = {name: sampler.name for name, sampler in learned.samplers.items()}
    run.write_json("metrics.json", metrics)
    stages = sorted(started.items(), key=lambda item: item[1])
    ends = [*(t for _, t in stages[1:]), start + seconds]
    run.write_json(
        "timings.json",
        {
            "seconds": round(seconds, 3),
            "stages": {name: round(end - begin, 3) for (name, begin), end in zip(stages, ends, strict=True)},
            "queries": vlm.usage.as_dict(),
            "demonstrations": vlm.usage.demos_dict(),
            "flow": settings.flow.model_dump(),
        },
    )
    return learned, metrics | {"seconds": round(seconds, 3)}


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
    doc = {"action": step.action, "operator": step.operator, "status": step.status, "detail": step.detail}
    return doc | ({"sampler": step.sampler, "rejections": step.rejections} if step.sampler else {})
