"""Executing plans: open loop, or looking after every skill and planning again when something went wrong (method 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pix2pred.execution.belief.perception import Perception
from pix2pred.execution.parameters import Parameters, executed
from pix2pred.execution.pursuit import MAX_REPLANS, GivenUpError, GivingUp, PlanFrom, Pursuit, assume_all
from pix2pred.structs import Atom, ExecutedStep, GroundOperator
from pix2pred.structs.environment import Environment, StepStatus
from pix2pred.structs.plans import changes_between, signed


@dataclass(frozen=True, slots=True)
class ExecutionResult:
    """How an episode went. ``failure`` is how the last skill failed, if one did; ``replans`` counts new plans.

    ``suspects`` are atoms that may have been misread when nothing was left to try.
    """

    goal_reached: bool
    failure: StepStatus | None
    detail: str
    steps: tuple[ExecutedStep, ...]
    replans: int = 0
    suspects: tuple[Atom, ...] = ()


def open_loop(plan: Sequence[GroundOperator], environment: Environment, parameters: Parameters) -> ExecutionResult:
    """Run the plan's skills one after the other, without looking, until the true goal holds or a skill fails."""
    steps: list[ExecutedStep] = []
    if environment.goal_reached():
        return ExecutionResult(True, None, "", ())
    for operator in plan:
        action, draw = parameters.choose(operator, environment)
        step = environment.execute(action)
        steps.append(executed(operator, action, draw, step))
        if environment.goal_reached():
            return ExecutionResult(True, None, "", tuple(steps))
        if step.status != StepStatus.DONE:
            return ExecutionResult(False, step.status, step.detail, tuple(steps))
    return ExecutionResult(False, None, "the plan was executed but the goal does not hold", tuple(steps))


@dataclass(slots=True)
class ClosedLoop:
    """Looks after every skill and plans again when the atoms that the rest of the plan needs do not hold.

    Gives up when no plan is found, when one skill keeps failing in states that look the same, or after
    ``max_replans``.
    """

    plan_from: PlanFrom
    goals: Sequence[Sequence[Atom]]
    max_replans: int = MAX_REPLANS

    def run(
        self, plan: Sequence[GroundOperator], perception: Perception, environment: Environment, parameters: Parameters
    ) -> ExecutionResult:
        """Execute ``plan``, made in the state that ``perception`` holds."""
        steps: list[ExecutedStep] = []
        pursuit = Pursuit(
            self.plan_from, self.goals, plan, perception, self.max_replans, may_assume=assume_all, resourceful=True
        )

        def failed(how: StepStatus | None, why: str) -> ExecutionResult:
            last = steps[-1] if steps and steps[-1].status != StepStatus.DONE else None
            if last is not None and last.detail not in why:
                how, why = how or StepStatus(last.status), f"{why}: {last.detail}"
            return ExecutionResult(False, how, why, tuple(steps), pursuit.replans)

        if environment.goal_reached():
            return ExecutionResult(True, None, "", ())
        try:
            while (operator := pursuit.next()) is not None:
                action, draw = parameters.choose(operator, environment)
                step = environment.execute(action)
                because = tuple(str(a) for a in pursuit.because)
                steps.append(replace(executed(operator, action, draw, step), turn=pursuit.turn, because=because))
                if environment.goal_reached():
                    return ExecutionResult(True, None, "", tuple(steps), pursuit.replans)
                if step.status == StepStatus.HORIZON:
                    return failed(step.status, step.detail)
                before, seen = perception.state, perception.advance(operator, environment.observe(), step.status)
                steps[-1] = replace(steps[-1], observed=signed(changes_between(before, seen)))
                succeeded = step.status == StepStatus.DONE and operator.add <= seen
                pursuit.executed(before, succeeded=succeeded)
        except GivenUpError as error:
            ended = failed(StepStatus.STUCK if error.kind == GivingUp.STUCK else None, str(error))
            return replace(ended, suspects=error.suspects)
        return failed(None, "the goal seems to hold but does not")
