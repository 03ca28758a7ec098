"""Executing plans: open loop, or looking after every skill and planning again when something went wrong (method 8)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from pix2pred.execution.monitor import necessary_atoms
from pix2pred.execution.parameters import Parameters, executed
from pix2pred.predicates import Abstraction
from pix2pred.structs import AbstractState, Action, Atom, ExecutedStep, GroundOperator, PlanResult, PlanStatus
from pix2pred.structs.environment import Environment, StepStatus


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an episode went. ``failure`` is how the last skill failed, if one did; ``replans`` counts new plans."""

    goal_reached: bool
    failure: StepStatus | None
    detail: str
    steps: tuple[ExecutedStep, ...]
    replans: int = 0


def actions_of(plan: Sequence[GroundOperator]) -> list[Action]:
    """The skills a plan executes, without continuous parameters."""
    return [Action(step.operator.skill, step.skill_objects) for step in plan]


def open_loop(plan: Sequence[GroundOperator], environment: Environment, parameters: Parameters) -> Outcome:
    """Run the plan's skills one after the other, without looking, until the true goal holds or a skill fails."""
    steps: list[ExecutedStep] = []
    if environment.goal_reached():
        return Outcome(True, None, "", ())
    for operator in plan:
        action, draw = parameters.choose(operator, environment)
        step = environment.execute(action)
        steps.append(executed(operator, action, draw, step))
        if environment.goal_reached():
            return Outcome(True, None, "", tuple(steps))
        if step.status != StepStatus.DONE:
            return Outcome(False, step.status, step.detail, tuple(steps))
    return Outcome(False, None, "the plan was executed but the goal does not hold", tuple(steps))


@dataclass(slots=True)
class ClosedLoop:
    """Looks after every skill and plans again when the atoms that the rest of the plan needs do not hold.

    Gives up when no plan is found, when one skill fails twice in states that look the same, or after ``max_replans``.
    """

    plan_from: Callable[[AbstractState], PlanResult]
    goal: Sequence[Atom]
    max_replans: int = 30

    def run(
        self,
        plan: Sequence[GroundOperator],
        seen: AbstractState,
        abstraction: Abstraction,
        environment: Environment,
        parameters: Parameters,
    ) -> Outcome:
        """Execute ``plan``, made in the state ``seen``, with which ``abstraction`` was started."""
        steps: list[ExecutedStep] = []
        failures: set[tuple[AbstractState, str]] = set()
        replans = position = 0
        needed = necessary_atoms(plan, self.goal)

        def failed(how: StepStatus | None, why: str) -> Outcome:
            return Outcome(False, how, why, tuple(steps), replans)

        if environment.goal_reached():
            return Outcome(True, None, "", ())
        while True:
            if not needed[position] <= seen:
                if replans >= self.max_replans:
                    return failed(None, f"gave up after planning again {replans} times")
                found = self.plan_from(seen)
                replans += 1
                if found.status != PlanStatus.SOLVED:
                    missing = ", ".join(str(a) for a in sorted(needed[position] - seen)[:3])
                    return failed(None, f"no plan any more ({found.status}) after {missing} turned out not to hold")
                plan, position = found.plan, 0
                needed = necessary_atoms(plan, self.goal)
            if position == len(plan):
                return failed(None, "the goal seems to hold but does not")
            operator = plan[position]
            action, draw = parameters.choose(operator, environment)
            step = environment.execute(action)
            steps.append(executed(operator, action, draw, step))
            if environment.goal_reached():
                return Outcome(True, None, "", tuple(steps), replans)
            if step.status == StepStatus.HORIZON:
                return failed(step.status, step.detail)
            before, seen = seen, abstraction.advance(action, environment.observe())
            steps[-1] = replace(steps[-1], observed=_changes(before, seen))
            if step.status != StepStatus.DONE or not operator.add <= seen:
                if (before, str(action)) in failures:
                    return failed(StepStatus.STUCK, f"{action} failed again in a state that looks the same")
                failures.add((before, str(action)))
            position += 1


def _changes(before: AbstractState, after: AbstractState) -> tuple[str, ...]:
    return (*(f"+{a}" for a in sorted(after - before)), *(f"-{a}" for a in sorted(before - after)))
