"""One task, one try: abstract the initial state, plan, execute, and name the cause when it fails (method 8)."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from pix2pred.execution.analogies import plan_by_analogy
from pix2pred.execution.avoiding import plan_avoiding
from pix2pred.execution.belief.denials import SeeingDenials
from pix2pred.execution.belief.perception import AtTheirWord, Believing, Perceiving, Perception
from pix2pred.execution.doubtful import nearest_plan, safer_plan, that_of
from pix2pred.execution.episode import ClosedLoop, ExecutionResult, open_loop
from pix2pred.execution.explaining.diagnosis import TruthOf, check_labels, correct_labels
from pix2pred.execution.explaining.rests import initial_needs
from pix2pred.execution.parameters import Announce, Parameters, tell_nobody
from pix2pred.execution.pursuit import Licence
from pix2pred.planning import TaskPlanner
from pix2pred.planning.alternatives import Goal, best_way
from pix2pred.predicates import StateLabeller
from pix2pred.structs import (
    AbstractState,
    Action,
    Episode,
    Failure,
    FromVLM,
    Operator,
    PlanResult,
    PlanStatus,
    Task,
    WhyAsked,
    WorldModel,
)
from pix2pred.structs.environment import Environment, StepStatus
from pix2pred.structs.goals.opposites import changing_denials, denied_in
from pix2pred.structs.samplers import Sampler


@dataclass(frozen=True, slots=True)
class Solver:
    """Solves tasks with one world model.

    ``closed_loop`` looks after every skill and plans again when needed; otherwise one plan is executed open loop, as
    the paper does in simulation. ``perceiving`` makes what knows the states: by default a belief in the closed loop,
    and labels taken at their word in the open one. ``max_skills`` is the longest plan accepted. ``samplers`` choose
    continuous parameters, by operator; their draws depend on ``seed`` and the task alone.
    """

    model: WorldModel
    planner: TaskPlanner
    labeller: StateLabeller
    closed_loop: bool = False
    max_skills: int = 200
    samplers: Mapping[str, Sampler] = field(default_factory=dict)
    seed: int = 0
    perceiving: Perceiving | None = None

    def plan(self, task: Task) -> tuple[AbstractState, PlanResult]:
        """What is seen of the initial state, and the plan made from it. Needs no simulator."""
        seen = self.perception(task).start(task.initial)
        return seen, self.plan_from(task, seen)

    def solve(
        self, task: Task, environment: Environment, truth: TruthOf | None = None, announce: Announce = tell_nobody
    ) -> Episode:
        """Plan and execute. ``truth`` knows the true values of visual atoms; it serves only to name a failure.

        ``announce`` is told every step before it is run.
        """
        environment.reset()
        perception = self.perception(task)
        perception.start(task.initial)
        result = self.first_plan(task, perception)
        seen = perception.state
        outcome = None
        if result.status == PlanStatus.SOLVED and self.closed_loop:
            loop = ClosedLoop(partial(self.plan_from, task), that_of(result, task.goals))
            outcome = loop.run(result.plan, perception, environment, self._parameters(task, announce))
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
            tuple(str(step.action) for step in result.plan),
            outcome.steps if outcome else (),
            tuple(sorted(a for a in seen if isinstance(a.predicate.source, FromVLM))),
            errors,
            result.nodes,
            outcome.replans if outcome else 0,
            tuple(perception.questions),
            tuple(dict.fromkeys((*perception.suspects, *(outcome.suspects if outcome else ())))),
        )

    def look_ahead(self, tasks: Sequence[Task]) -> None:
        """Have the first states of all ``tasks`` labelled side by side, so that they need not wait for one another.

        Only for a model that keeps its answers: they are asked for again, and then found, when a task is solved.
        """
        for _ in self.labeller.together.map(lambda task: self.perception(task).start(task.initial), tasks):
            pass

    def perception(self, task: Task, otherwise: Perceiving | None = None) -> Perception:
        """What knows the states of one episode of ``task``; ``otherwise`` in place of the default."""
        perceiving = self.perceiving or otherwise or (Believing() if self.closed_loop else AtTheirWord)
        made = perceiving(self.model, task, self.labeller)
        denied = denied_in(atom for goal in task.goals for atom in goal)
        return SeeingDenials(made, self.model, task, denied) if denied else made

    def operators(self, task: Task) -> tuple[Operator, ...]:
        """The learned operators, which change as well what the goals of ``task`` say must not hold."""
        return changing_denials(self.model.operators, denied_in(atom for goal in task.goals for atom in goal))

    def first_plan(self, task: Task, perception: Perception) -> PlanResult:
        """A plan from what ``perception`` holds, after the atoms in doubt that it rests on were asked about again.

        Without a plan, what the nearest state with a plan differs in is asked about first.
        """
        found = self.plan_from(task, perception.state)
        if found.status == PlanStatus.SOLVED:
            resting = initial_needs(found.plan, found.goal or task.goal)
            made = {atom for step in found.plan for atom in step.add} - perception.state
            if perception.ask(perception.doubts(resting | made), WhyAsked.IN_DOUBT):
                found = self.plan_from(task, perception.state)
            doubted = perception.doubts(initial_needs(found.plan, found.goal or task.goal) & perception.state)
            aim = found.goal or task.goal
            safer = safer_plan(partial(self.plan_from, task), aim, perception, found.plan, doubted)
            return found if safer is None else replace(safer, nodes=found.nodes, seconds=found.seconds)
        nearest = nearest_plan(partial(self.plan_from, task), task.goals, perception)
        if nearest is None and self.closed_loop:
            by_analogy = self.plan_from(task, perception.state, licence=Licence.BY_ANALOGY)
            return by_analogy if by_analogy.status == PlanStatus.SOLVED else found
        if nearest is None or (nearest.assumed and not self.closed_loop):
            return found
        return replace(nearest.found, nodes=found.nodes, seconds=found.seconds)

    def _parameters(self, task: Task, announce: Announce = tell_nobody) -> Parameters:
        return Parameters.for_task(self.samplers, self.seed, task, announce)

    def plan_from(
        self, task: Task, seen: AbstractState, avoided: Collection[Action] = (), licence: Licence = Licence.LEARNED
    ) -> PlanResult:
        """A plan for ``task`` from the state ``seen``, without the actions ``avoided``, of what ``licence`` permits.

        Of several goals the one that takes the fewest steps is planned for.
        """
        learned, objects = self.operators(task), task.objects
        changed = licence is Licence.AFTER_A_CHANGE

        def plan(goal: Goal, operators: Sequence[Operator], state: AbstractState) -> PlanResult:
            given = (operators, objects, state, goal)
            if avoided:
                return plan_avoiding(self.planner, *given, avoided, until_changed=changed)
            return self.planner.plan(*given)

        def way(goal: Goal) -> PlanResult:
            if licence is Licence.BY_ANALOGY:
                found = plan_by_analogy(partial(plan, goal), learned, objects, seen)
            else:
                found = plan(goal, learned, seen)
            if len(found.plan) > self.max_skills:
                return PlanResult(PlanStatus.BUDGET, (), found.nodes, found.seconds)
            return found

        return best_way(task.goals, way) if task.alternatives else way(task.goal)

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
        errors, denied = check.wrong, denied_in(atom for goal in task.goals for atom in goal)
        named = tuple(f"{atom} is {value}" for atom, value in sorted(errors.items()))
        better = self.plan_from(task, correct_labels(seen, errors, denied)) if errors else result
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
