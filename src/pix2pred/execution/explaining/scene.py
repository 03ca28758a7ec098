"""A plan for a photographed scene, with everything it rests on, or with what stands in the way of one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from pix2pred.execution.belief.perception import Believing, Perception
from pix2pred.execution.belief.unlabelled import unlabelled
from pix2pred.execution.explaining.missing import Missing, missing
from pix2pred.execution.explaining.rests import Need, initial_needs, needs
from pix2pred.execution.solver import Solver
from pix2pred.predicates import StateLabels
from pix2pred.predicates.labelling.explanations import explanations
from pix2pred.predicates.prompt import atom_text
from pix2pred.structs import AbstractState, Atom, FromDomain, FromHuman, Label, PlanResult, PlanStatus, Task


@dataclass(frozen=True)
class PlannedScene:
    """What was seen of the initial state of the task ``asked``, and the plan made from it.

    ``task`` is that one with the goal that was planned for. ``labels`` are the model's answers; ``perception`` holds
    what is believed, and goes on from here when somebody executes the plan. ``believed`` are the probabilities of the
    visual atoms when the plan was made.
    """

    solver: Solver
    asked: Task
    task: Task
    perception: Perception
    labels: StateLabels
    seen: AbstractState
    result: PlanResult
    believed: Mapping[Atom, float]

    @property
    def solved(self) -> bool:
        """Whether there is a plan; it may be empty."""
        return self.result.status == PlanStatus.SOLVED

    @property
    def actions(self) -> tuple[str, ...]:
        """The skills of the plan, as ``Pick(robot, cup)``."""
        return tuple(str(step.action) for step in self.result.plan)

    @cached_property
    def needs(self) -> tuple[tuple[Need, ...], ...]:
        """What each step needs and where it comes from; the goal comes last. Empty without a plan."""
        return needs(self.result.plan, self.task.goal) if self.solved else ()

    @cached_property
    def rests_on(self) -> tuple[Atom, ...]:
        """The atoms of the initial state that the plan needs."""
        return tuple(sorted(initial_needs(self.result.plan, self.task.goal))) if self.solved else ()

    @cached_property
    def unlabelled(self) -> tuple[Atom, ...]:
        """Atoms that the model called unknown or gave no value, when asked again too; planning took them for false."""
        told = {q.atom for q in self.perception.questions if q.state == 0 and {*q.answers} != {Label.UNKNOWN.word}}
        return tuple(a for a in unlabelled(self.labels) if a not in told)

    @cached_property
    def said(self) -> Mapping[Atom, str]:
        """The words with which the model explained its labels, where it did."""
        return said(self.labels)

    @cached_property
    def missing(self) -> tuple[Missing, ...]:
        """Without a plan: the goal atoms that cannot be reached, each followed by what it lacks."""
        if self.result.status != PlanStatus.UNSOLVABLE:
            return ()
        return missing(self.solver.operators(self.task), self.task.objects, self.seen, self.task.goal)

    @cached_property
    def would_help(self) -> tuple[Atom, ...]:
        """Without a plan: unlabelled atoms that a plan would rest on if all of them were true; empty if none would."""
        if self.solved or not self.unlabelled:
            return ()
        found = self.solver.plan_from(self.task, self.seen | set(self.unlabelled))
        if found.status != PlanStatus.SOLVED:
            return ()
        used = initial_needs(found.plan, self.task.goal)
        return tuple(a for a in self.unlabelled if a in used)


def said(labels: StateLabels) -> dict[Atom, str]:
    """The words with which a model explained ``labels``, where it did."""
    texts = {a: atom_text(a) for a in labels.values}
    words = explanations(labels.text, list(texts.values()))
    return {a: words[text] for a, text in sorted(texts.items()) if text in words}


def plan_scene(solver: Solver, task: Task) -> PlannedScene:
    """Label the photos of ``task``, and plan. Raises ``UnusableAnswersError`` when the model labels nothing."""
    perception = solver.perception(task, otherwise=Believing())
    perception.start(task.initial)
    result = solver.first_plan(task, perception)
    aimed = task if result.goal is None else replace(task, goal=result.goal, alternatives=())
    believed = {atom: perception.probability(atom) for atom in perception.labels.values}
    return PlannedScene(solver, task, aimed, perception, perception.labels, perception.state, result, believed)


def listed(atoms: Iterable[Atom]) -> frozenset[Atom]:
    """Those of ``atoms`` that neither a model nor a rule gives a value: a person or a domain lists them."""
    return frozenset(a for a in atoms if isinstance(a.predicate.source, FromDomain | FromHuman))
