"""One task, one try: abstract the initial state, plan once, execute open loop (method 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.execution.diagnosis import TruthOf, correct_labels, wrong_labels
from pix2pred.planning import Planner
from pix2pred.predicates import Labeller, abstract
from pix2pred.structs import (
    AbstractState,
    Action,
    Episode,
    ExecutedStep,
    Failure,
    FromVLM,
    GroundOperator,
    PlanResult,
    PlanStatus,
    Task,
    WorldModel,
)
from pix2pred.structs.environment import Environment, StepStatus


@dataclass(frozen=True, slots=True)
class Outcome:
    """How executing a plan went: None when the goal was reached."""

    failure: StepStatus | None
    goal_reached: bool
    detail: str
    steps: tuple[ExecutedStep, ...]


@dataclass(frozen=True, slots=True)
class Solver:
    """Solves tasks with one world model. ``max_skills`` is the longest plan accepted."""

    model: WorldModel
    planner: Planner
    labeller: Labeller
    max_skills: int = 200

    def plan(self, task: Task) -> tuple[AbstractState, PlanResult]:
        """What is seen of the initial state, and the plan made from it. Needs no simulator."""
        seen, _ = abstract(task.initial, task.objects, self.model.predicates, self.labeller)
        return seen, self._plan_from(task, seen)

    def solve(self, task: Task, environment: Environment, truth: TruthOf | None = None) -> Episode:
        """Plan and execute. ``truth`` knows the true values of visual atoms; it serves only to name a failure."""
        environment.reset()
        seen, result = self.plan(task)
        outcome = execute(result.plan, environment) if result.status == PlanStatus.SOLVED else None
        failure: Failure | None = None
        detail, errors = "", tuple[str, ...]()
        if outcome is None or not outcome.goal_reached:
            failure, detail, errors = self._diagnose(task, environment, truth, seen, result, outcome)
        return Episode(
            task.name,
            failure,
            detail,
            tuple(str(a) for a in actions_of(result.plan)),
            outcome.steps if outcome else (),
            tuple(sorted(a for a in seen if isinstance(a.predicate.source, FromVLM))),
            errors,
            result.nodes,
        )

    def _plan_from(self, task: Task, seen: AbstractState) -> PlanResult:
        found = self.planner.plan(self.model.operators, task.objects, seen, task.goal)
        if len(found.plan) > self.max_skills:
            return PlanResult(PlanStatus.BUDGET, (), found.nodes, found.seconds)
        return found

    def _diagnose(
        self,
        task: Task,
        environment: Environment,
        truth: TruthOf | None,
        seen: AbstractState,
        result: PlanResult,
        outcome: Outcome | None,
    ) -> tuple[Failure, str, tuple[str, ...]]:
        """The cause of a failure: labels if true labels would have helped, else the model, as far as can be told."""
        if result.status == PlanStatus.BUDGET:
            return Failure.BUDGET, f"no plan within the budget ({result.nodes} nodes)", ()
        detail = outcome.detail if outcome else "the goal cannot be reached with the learned operators"
        if outcome and outcome.failure == StepStatus.HORIZON:
            return Failure.HORIZON, detail, ()
        environment.reset()
        errors = wrong_labels(truth, seen, task, self.model) if truth else None
        if errors is None:
            cause = Failure.NO_PLAN if outcome is None else Failure.SKILL if outcome.failure else Failure.UNDETERMINED
            return cause, detail, ()
        if not errors:
            return (Failure.NO_PLAN if outcome is None else Failure.WRONG_MODEL), detail, ()
        better = self._plan_from(task, correct_labels(seen, errors))
        helps = better.status == PlanStatus.SOLVED and execute(better.plan, environment).goal_reached
        cause = Failure.WRONG_LABEL if helps else Failure.WRONG_MODEL
        return cause, detail, tuple(f"{atom} is {value}" for atom, value in sorted(errors.items()))


def actions_of(plan: Sequence[GroundOperator]) -> list[Action]:
    """The skills a plan executes."""
    return [Action(step.operator.skill, step.skill_objects) for step in plan]


def execute(plan: Sequence[GroundOperator], environment: Environment) -> Outcome:
    """Run the plan's skills one after the other, without looking, until the true goal holds or a skill fails."""
    steps: list[ExecutedStep] = []
    for operator, action in zip(plan, actions_of(plan), strict=True):
        step = environment.execute(action)
        steps.append(ExecutedStep(str(action), str(operator), step.status, step.detail))
        if environment.goal_reached():
            return Outcome(None, True, "", tuple(steps))
        if step.status != StepStatus.DONE:
            return Outcome(step.status, False, step.detail, tuple(steps))
    done = environment.goal_reached()
    return Outcome(None, done, "" if done else "the plan was executed but the goal does not hold", tuple(steps))
