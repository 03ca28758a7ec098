"""One task, one try: abstract the initial state, plan, execute, and name the cause when it fails (method 8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from pix2pred.execution.episode import ClosedLoop, ExecutionResult, actions_of, open_loop
from pix2pred.execution.explaining.diagnosis import TruthOf, check_labels, correct_labels
from pix2pred.execution.parameters import Announce, Parameters, tell_nobody
from pix2pred.planning import TaskPlanner
from pix2pred.predicates import Abstraction, StateLabeller
from pix2pred.structs import AbstractState, Episode, Failure, FromVLM, PlanResult, PlanStatus, Task, WorldModel
from pix2pred.structs.environment import Environment, StepStatus
from pix2pred.structs.samplers import Sampler


@dataclass(frozen=True, slots=True)
class Solver:
    """Solves tasks with one world model.

    ``closed_loop`` looks after every skill and plans again when needed; otherwise one plan is executed open loop, as
    the paper does in simulation. ``max_skills`` is the longest plan accepted. ``samplers`` choose continuous
    parameters, by operator; their draws depend on ``seed`` and the task alone.
    """

    model: WorldModel
    planner: TaskPlanner
    labeller: StateLabeller
    closed_loop: bool = False
    max_skills: int = 200
    samplers: Mapping[str, Sampler] = field(default_factory=dict)
    seed: int = 0

    def plan(self, task: Task) -> tuple[AbstractState, PlanResult]:
        """What is seen of the initial state, and the plan made from it. Needs no simulator."""
        seen = self.abstraction(task).start(task.initial)
        return seen, self.plan_from(task, seen)

    def solve(
        self,
        task: Task,
        environment: Environment,
        truth: TruthOf | None = None,
        announce: Announce = tell_nobody,
    ) -> Episode:
        """Plan and execute. ``truth`` knows the true values of visual atoms; it serves only to name a failure.

        ``announce`` is told every step before it is run.
        """
        environment.reset()
        abstraction = self.abstraction(task)
        seen = abstraction.start(task.initial)
        result = self.plan_from(task, seen)
        outcome = None
        if result.status == PlanStatus.SOLVED and self.closed_loop:
            loop = ClosedLoop(lambda now: self.plan_from(task, now), task.goal)
            outcome = loop.run(result.plan, seen, abstraction, environment, self._parameters(task, announce))
        elif result.status == PlanStatus.SOLVED:
            outcome = open_loop(result.plan, environment, self._parameters(task, announce))
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
            outcome.replans if outcome else 0,
        )

    def abstraction(self, task: Task) -> Abstraction:
        """What labels the states of one episode of ``task``."""
        return Abstraction(task.objects, self.model.predicates, self.labeller, about=f"task {task.name}")

    def look_ahead(self, tasks: Sequence[Task]) -> None:
        """Have the first states of all ``tasks`` labelled side by side, so that they need not wait for one another.

        Only for a model that keeps its answers: they are asked for again, and then found, when a task is solved.
        """
        for _ in self.labeller.together.map(lambda task: self.abstraction(task).start(task.initial), tasks):
            pass

    def _parameters(self, task: Task, announce: Announce = tell_nobody) -> Parameters:
        return Parameters.for_task(self.samplers, self.seed, task, announce)

    def plan_from(self, task: Task, seen: AbstractState) -> PlanResult:
        """A plan for ``task`` from the state ``seen``."""
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
        outcome: ExecutionResult | None,
    ) -> tuple[Failure, str, tuple[str, ...]]:
        """The cause of a failure: labels if true labels would have helped, else the model, as far as can be told."""
        if result.status == PlanStatus.BUDGET:
            return Failure.BUDGET, f"no plan of at most {self.max_skills} skills within the budget of nodes", ()
        if result.status == PlanStatus.TIMEOUT:
            return Failure.BUDGET, f"the planner was stopped after {result.seconds:.0f} s", ()
        if result.status == PlanStatus.NOT_FOUND:
            return Failure.NO_PLAN, "the planner gave up without a plan and without a proof that there is none", ()
        detail = outcome.detail if outcome else "the goal cannot be reached with the learned operators"
        if outcome and outcome.failure == StepStatus.HORIZON:
            return Failure.HORIZON, detail, ()
        if outcome and outcome.failure and outcome.steps[-1].sampler:
            return Failure.SKILL, f"{detail} (parameters from the sampler {outcome.steps[-1].sampler!r})", ()
        environment.reset()
        check = check_labels(truth, seen, task, self.model)
        if truth is None or check.unknown:
            cause = Failure.NO_PLAN if outcome is None else Failure.SKILL if outcome.failure else Failure.UNDETERMINED
            return cause, detail, ()
        errors = check.wrong
        named = tuple(f"{atom} is {value}" for atom, value in sorted(errors.items()))
        better = self.plan_from(task, correct_labels(seen, errors)) if errors else result
        if better.status not in (PlanStatus.SOLVED, PlanStatus.UNSOLVABLE):
            return Failure.UNDETERMINED, detail, named
        helps = (
            better.status == PlanStatus.SOLVED
            and open_loop(better.plan, environment, self._parameters(task)).goal_reached
        )
        if errors and helps:
            return Failure.WRONG_LABEL, detail, named
        if outcome is None and not errors:
            return Failure.NO_PLAN, detail, named
        # the first plan was fine by itself: what went wrong came later and is not known
        return (Failure.UNDETERMINED if helps else Failure.WRONG_MODEL), detail, named
