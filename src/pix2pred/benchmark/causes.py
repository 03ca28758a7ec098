"""Where a failure comes from: plan again with true labels, then learn again with true labels (method 8.4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from pix2pred.approaches.approach import ModelAgent
from pix2pred.benchmark.rows import Cause
from pix2pred.execution import TruthOf
from pix2pred.execution.episode import open_loop
from pix2pred.execution.explaining.diagnosis import LabelCheck, check_labels, correct_labels, given_atoms, visual
from pix2pred.execution.explaining.replayed_demos import TruthInDemo
from pix2pred.execution.parameters import Parameters
from pix2pred.predicates import labeller_for
from pix2pred.structs import Episode, Failure, FromVLM, PlanStatus, Task
from pix2pred.structs.environment import Environment


def cause_of(
    episode: Episode,
    check: LabelCheck,
    agent: ModelAgent,
    task: Task,
    environment: Environment,
    truth: TruthOf | None,
    relearned: Callable[[], ModelAgent | None],
) -> Cause:
    """The cause of a failed episode.

    ``relearned`` gives the agent that true labels in the demonstrations would have made, or None when they are not
    known.
    """
    if episode.failure == Failure.BUDGET:
        return Cause.BUDGET
    if check.wrong and _solves(agent, task, environment, truth, episode):
        return Cause.WRONG_LABEL
    if not visual([c.predicate for c in agent.learned.labelling.table.pool]):
        return Cause.WRONG_MODEL if not check.unknown else Cause.UNDETERMINED
    better = relearned()
    if better is not None and _solves(better, task, environment, truth, episode):
        return Cause.WRONG_TRAINING_LABEL
    open_questions = check.unknown or better is None or truth is None
    return Cause.UNDETERMINED if open_questions else Cause.WRONG_MODEL


def _solves(agent: ModelAgent, task: Task, environment: Environment, truth: TruthOf | None, episode: Episode) -> bool:
    """Whether ``agent``'s model, with true labels of the initial state, gives a plan that works."""
    environment.reset()
    seen = frozenset(episode.labels)
    given = given_atoms(
        agent.model, labeller_for(agent.training.problem.vlm, agent.training.problem.settings.labels), task
    )
    state = given | correct_labels(seen, check_labels(truth, seen, task, agent.model).wrong)
    found = agent.training.planner.plan(agent.model.operators, task.objects, state, task.goal)
    parameters = Parameters.for_task(agent.learned.samplers, 0, task)
    return found.status == PlanStatus.SOLVED and open_loop(found.plan, environment, parameters).goal_reached


def training_errors(agent: ModelAgent, truth: TruthInDemo) -> Mapping[str, int]:
    """How many labels of the demonstrations have a known truth, and how many of those are wrong."""
    known = wrong = 0
    for d, demo in enumerate(agent.learned.labelling.table.demos):
        held = demo.values == 1
        for i, atom in enumerate(demo.atoms):
            if isinstance(atom.predicate.source, FromVLM):
                for t in range(len(held)):
                    value = truth(d, t, atom)
                    known += value is not None
                    wrong += value is not None and value != bool(held[t, i])
    return {"labels": known, "label_errors": wrong}
