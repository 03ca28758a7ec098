"""Solving tasks into a run folder: a file per episode, as soon as it ends."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pix2pred.execution import Solver, TruthOf
from pix2pred.execution.film import Film, FilmedEpisode
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.layout import SOLVED, SUMMARY
from pix2pred.structs import Episode, ExecutedStep, Failure, Question, Turn
from pix2pred.structs.environment import Environment, SimulatedTask
from pix2pred.system.progress import Progress, Stage
from pix2pred.vlm.distilled.tally import Tallied, Tally


@dataclass(frozen=True, slots=True)
class Solved:
    """All episodes of one set of tasks; ``said_by`` counts who gave the labels, where two models shared the work."""

    episodes: tuple[Episode, ...]
    said_by: Tally | None = None

    def as_dict(self) -> dict[str, Any]:
        """Counts, failures by cause, and a row per episode."""
        failures = Counter(e.failure.value for e in self.episodes if e.failure)
        return {
            "solved": sum(e.solved for e in self.episodes),
            "tasks": len(self.episodes),
            "failures": {cause.value: failures[cause.value] for cause in Failure if failures[cause.value]},
            "episodes": [episode_doc(e) for e in self.episodes],
            **({} if self.said_by is None else {"said_by": self.said_by.as_dict()}),
        }


EnvironmentFor = Callable[[SimulatedTask], tuple[Environment, TruthOf | None]]
"""A fresh episode of a task, and what is known of the truth in it."""


def solve_into(
    run: RunFolder,
    name: str,
    tasks: Sequence[SimulatedTask],
    solver: Solver,
    environment_for: EnvironmentFor,
    progress: Progress,
    film: Film | None = None,
) -> Solved:
    """Try every task once and write a file per episode, as soon as it ends; ``film`` records them all.

    The first states of all tasks are labelled side by side, before the first task begins; the solver's model has to
    keep its answers.
    """
    progress(Stage.SOLVE, 0, len(tasks), "first states")
    solver.look_ahead([stored.task for stored in tasks])
    episodes = []
    for i, stored in enumerate(tasks):
        progress(Stage.SOLVE, i, len(tasks), stored.task.name)
        environment, truth = environment_for(stored)
        if film is None:
            episode = solver.solve(stored.task, environment, truth)
        else:
            filmed = FilmedEpisode(environment, film, stored.task.name)
            episode = solver.solve(stored.task, filmed, truth, filmed.announce)
            filmed.conclude(["goal reached"] if episode.solved else [f"failed: {episode.failure}", episode.detail])
        run.write_json(f"{SOLVED}/{name}/{stored.task.name}.json", episode_doc(episode))
        episodes.append(episode)
    progress(Stage.SOLVE, len(tasks), len(tasks), "")
    asked = solver.labeller.vlm
    solved = Solved(tuple(episodes), asked.tally if isinstance(asked, Tallied) else None)
    run.write_json(f"{SOLVED}/{name}/{SUMMARY}", solved.as_dict())
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
        **({"asked_again": [_question_doc(q) for q in episode.questions]} if episode.questions else {}),
        **({"suspects": [str(a) for a in episode.suspects]} if episode.suspects else {}),
    }


def _question_doc(question: Question) -> dict[str, Any]:
    return {
        "state": question.state,
        "atom": str(question.atom),
        "why": question.why.value,
        "answers": list(question.answers),
        "before": question.before,
        "after": question.after,
        "changed": question.changed,
    }


def _step_doc(step: ExecutedStep) -> dict[str, Any]:
    doc = {
        "action": step.action,
        "operator": step.operator,
        "status": step.status,
        "detail": step.detail,
        "observed": None if step.observed is None else list(step.observed),
    }
    if step.turn != Turn.FOLLOWED:
        doc |= {"turn": step.turn.value, "because": list(step.because)}
    return doc | ({"sampler": step.sampler, "rejections": step.rejections} if step.sampler else {})
