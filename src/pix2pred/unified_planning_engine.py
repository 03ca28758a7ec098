"""The planner as an engine of unified-planning, for problems that were made there.

    from unified_planning.shortcuts import OneshotPlanner
    import pix2pred.unified_planning_engine

    with OneshotPlanner(name="pix2pred") as planner:
        result = planner.solve(problem)

Importing this module tells the global environment of the engine; ``register`` tells another one. The way back, from a
learned model to a problem, is ``Model.to_unified_planning``.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import IO, Any

from unified_planning.engines import Credits, Engine, PlanGenerationResult, PlanGenerationResultStatus
from unified_planning.engines.mixins import OneshotPlannerMixin
from unified_planning.engines.mixins.oneshot_planner import OptimalityGuarantee
from unified_planning.environment import Environment, get_environment
from unified_planning.io import PDDLWriter
from unified_planning.model import AbstractProblem, Problem, ProblemKind
from unified_planning.plans import ActionInstance, SequentialPlan

from pix2pred.planners import Planners
from pix2pred.planning import Planner
from pix2pred.planning.pddl.plans import solve_pddl
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.structs import PlanStatus

_STATUSES = {
    PlanStatus.SOLVED: PlanGenerationResultStatus.SOLVED_SATISFICING,
    PlanStatus.UNSOLVABLE: PlanGenerationResultStatus.UNSOLVABLE_PROVEN,
    PlanStatus.BUDGET: PlanGenerationResultStatus.MEMOUT,
    PlanStatus.TIMEOUT: PlanGenerationResultStatus.TIMEOUT,
}


def register(environment: Environment | None = None) -> None:
    """Make ``OneshotPlanner(name="pix2pred")`` known to an environment, by default the global one."""
    (environment or get_environment()).factory.add_engine("pix2pred", __name__, "Pix2predEngine")


class Pix2predEngine(Engine, OneshotPlannerMixin):  # type: ignore[misc]  # the package has no types
    """Searches of ours for problems of unified-planning, which come in as PDDL.

    ``planner`` is one of the names that ``pix2pred plan-pddl --planner`` takes, of those that are no engines of others.
    A search is bounded by nodes, so that the same problem has the same plan on every machine; a time-out is not kept.
    """

    def __init__(self, planner: str = "quick") -> None:
        Engine.__init__(self)
        OneshotPlannerMixin.__init__(self)
        made = Planners().planner(planner)
        if not isinstance(made, Planner):
            raise ValueError(f"{planner} is an engine of unified-planning itself; ask for it there")
        self._planner = made

    @property
    def name(self) -> str:
        """The name it is asked for by."""
        return "pix2pred"

    @staticmethod
    def supported_kind() -> ProblemKind:
        """Classical problems with any conditions, conditional effects, and costs of actions as the only numbers."""
        kind = ProblemKind(version=2)
        kind.set_problem_class("ACTION_BASED")
        for typing in ("FLAT_TYPING", "HIERARCHICAL_TYPING"):
            kind.set_typing(typing)
        for condition in ("NEGATIVE", "DISJUNCTIVE", "EXISTENTIAL", "UNIVERSAL"):
            kind.set_conditions_kind(f"{condition}_CONDITIONS")
        kind.set_conditions_kind("EQUALITIES")
        for effect in ("CONDITIONAL_EFFECTS", "FORALL_EFFECTS"):
            kind.set_effects_kind(effect)
        for metric in ("ACTIONS_COST", "PLAN_LENGTH"):
            kind.set_quality_metrics(metric)
        for cost in ("STATIC_FLUENTS_IN_ACTIONS_COST", "INT_NUMBERS_IN_ACTIONS_COST"):
            kind.set_actions_cost_kind(cost)
        return kind

    @staticmethod
    def supports(problem_kind: ProblemKind) -> bool:
        """Whether every feature of a problem is among those."""
        return bool(problem_kind <= Pix2predEngine.supported_kind())

    @staticmethod
    def satisfies(optimality_guarantee: OptimalityGuarantee) -> bool:
        """Plans are short but not always shortest."""
        return bool(optimality_guarantee == OptimalityGuarantee.SATISFICING)

    @staticmethod
    def get_credits(**kwargs: Any) -> Credits:
        """What unified-planning prints about an engine before it is used."""
        return Credits(
            "pix2pred",
            "The pix2pred authors",
            "",
            "https://arxiv.org/abs/2501.00296",
            "MIT",
            "Greedy and A* searches in Python.",
            "Searches with FF and landmark-cut heuristics in Python, bounded by nodes and deterministic.",
        )

    def _solve(
        self,
        problem: AbstractProblem,
        heuristic: Callable[[Any], float | None] | None = None,
        timeout: float | None = None,
        output_stream: IO[str] | None = None,
    ) -> PlanGenerationResult:
        if not isinstance(problem, Problem):
            raise TypeError(f"expected a Problem, got {type(problem).__name__}")
        for what, given in (("a heuristic", heuristic), ("a time-out", timeout), ("an output stream", output_stream)):
            if given is not None:
                warnings.warn(f"pix2pred has no use for {what}", UserWarning, stacklevel=3)
        writer = PDDLWriter(problem)
        domain = read_domain(writer.get_domain())
        found = solve_pddl(domain, read_problem(writer.get_problem(), domain), self._planner)
        plan = None
        if found.status == PlanStatus.SOLVED:
            manager = problem.environment.expression_manager
            plan = SequentialPlan(
                [
                    ActionInstance(
                        writer.get_item_named(step.action),
                        tuple(manager.ObjectExp(writer.get_item_named(name)) for name in step.objects),
                    )
                    for step in found.steps
                ],
                problem.environment,
            )
        return PlanGenerationResult(_STATUSES[found.status], plan, self.name)


register()
