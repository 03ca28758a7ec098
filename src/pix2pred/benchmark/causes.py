"""Where a failure comes from: plan again with true labels, then learn again with true labels (method 8.4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from pix2pred.approaches.approach import ModelAgent, TruthInDemo
from pix2pred.benchmark.rows import Cause
from pix2pred.execution import TruthOf
from pix2pred.execution.episode import open_loop
from pix2pred.execution.parameters import Parameters
from pix2pred.predicates import Abstraction, Labeller, ground_atoms
from pix2pred.structs import AbstractState, Atom, Demo, Episode, Failure, FromVLM, PlanStatus, Predicate, Task
from pix2pred.structs.environment import Environment, SimulatedTask


@runtime_checkable
class Replayable(Protocol):
    """A domain that gives the start of each demonstration, so that its states can be visited again."""

    def demonstration_starts(self, family: str, seed: int) -> Sequence[SimulatedTask]:
        """The initial states of ``demonstrations(family, seed)``, in the same order."""
        ...


@dataclass(frozen=True, slots=True)
class LabelCheck:
    """Visual atoms of a task's initial state: how many have a known truth, which were labelled wrongly."""

    known: int
    wrong: tuple[Atom, ...]
    unknown: int


def visual(predicates: Sequence[Predicate]) -> list[Predicate]:
    """Those that are read from pictures."""
    return [p for p in predicates if isinstance(p.source, FromVLM)]


def check_labels(episode: Episode, agent: ModelAgent, task: Task, truth: TruthOf | None) -> LabelCheck:
    """Compare the labels an episode began with to the truth; the environment must be in the initial state."""
    seen = set(episode.labels)
    known, wrong, unknown = 0, [], 0
    for atom in ground_atoms(visual(agent.model.predicates), task.objects):
        value = truth(atom) if truth else None
        if value is None:
            unknown += 1
            continue
        known += 1
        if value != (atom in seen):
            wrong.append(atom)
    return LabelCheck(known, tuple(wrong), unknown)


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
    state = _true_state(agent, task, truth, frozenset(episode.labels))
    found = agent.training.planner.plan(agent.model.operators, task.objects, state, task.goal)
    parameters = Parameters.for_task(agent.learned.samplers, 0, task)
    return found.status == PlanStatus.SOLVED and open_loop(found.plan, environment, parameters).goal_reached


def _true_state(agent: ModelAgent, task: Task, truth: TruthOf | None, seen: AbstractState) -> AbstractState:
    asked = visual(agent.model.predicates)
    others = [p for p in agent.model.predicates if p not in asked]
    labeller = Labeller(agent.training.vlm, agent.training.settings.labels)
    state = set(Abstraction(task.objects, others, labeller).start(task.initial))
    for atom in ground_atoms(asked, task.objects):
        value = truth(atom) if truth else None
        if atom in seen if value is None else value:
            state.add(atom)
    return frozenset(state)


TruthNow = Callable[[Environment], TruthOf | None]
"""What is known of the truth in an environment's present state."""


def truths_of_demos(
    demos: Sequence[Demo],
    starts: Sequence[SimulatedTask],
    environment_for: Callable[[SimulatedTask], Environment],
    truth_now: TruthNow,
    predicates: Sequence[Predicate],
) -> TruthInDemo:
    """Visit the states of the demonstrations again and note the truth of every visual atom."""
    known: dict[tuple[int, int, Atom], bool] = {}
    for d, (demo, start) in enumerate(zip(demos, starts, strict=False)):
        environment = environment_for(start)
        environment.reset()
        atoms = ground_atoms(visual(predicates), demo.objects)
        for t in range(len(demo.states)):
            if t:
                environment.execute(demo.actions[t - 1])
            truth = truth_now(environment)
            for atom in atoms:
                value = truth(atom) if truth else None
                if value is not None:
                    known[d, t, atom] = value
    return lambda d, t, atom: known.get((d, t, atom))


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
