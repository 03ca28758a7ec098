"""Solving the test problems with a learned model and trying the plans in the true domain."""

from __future__ import annotations

import signal
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from types import FrameType
from typing import Any

from pix2pred.planning import GreedyBestFirst, Planner
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem
from pix2pred.structs import AbstractState, GroundOperator, Object, Operator, PlanStatus, groundings
from pix2pred.structs.formats.building import build_operator
from pix2pred.structs.formats.documents import OperatorDoc
from pix2pred.structs.formats.names import DeclaredNames
from symbolic.traces import Workload

MAX_NODES = 20_000
MAX_SECONDS = 5.0
"""Of processor time, for one problem: only models that are wrong come near it."""


class Verdict(StrEnum):
    """What became of one test problem."""

    SOLVED = "solved"
    NO_PLAN = "no plan"
    BUDGET = "budget"
    REFUSED = "an action was not applicable"
    """The model knows too few preconditions, or effects that
    do not occur."""
    MISSED = "the goal was not reached"


@dataclass(frozen=True, slots=True)
class Score:
    """Verdicts in the order of the test problems."""

    verdicts: tuple[Verdict, ...]

    @property
    def solved(self) -> int:
        """How many plans worked."""
        return sum(v == Verdict.SOLVED for v in self.verdicts)

    def __str__(self) -> str:
        failures = Counter(v.value for v in self.verdicts if v != Verdict.SOLVED)
        return f"{self.solved}/{len(self.verdicts)}" + "".join(f", {n} {what}" for what, n in sorted(failures.items()))


def score_model(
    workload: Workload, selected: Sequence[str], operators: Sequence[Operator], max_seconds: float = MAX_SECONDS
) -> Score:
    """Score operators over given and ``selected`` predicates, for example of a ``Selection``."""
    planner = Planner(GreedyBestFirst(max_nodes=MAX_NODES))
    verdicts = []
    for problem in workload.tests:
        initial = workload.initial_state(problem, selected)
        try:
            with _processor_time(max_seconds):
                found = planner.plan(operators, problem.objects, initial, problem.goal)
        except TimeoutError:
            verdicts.append(Verdict.BUDGET)
            continue
        if found.status == PlanStatus.SOLVED:
            steps = [(step.operator.skill.name, step.skill_objects) for step in found.plan]
            verdicts.append(execute(workload.domain, problem, steps))
        else:
            verdicts.append(Verdict.BUDGET if found.status == PlanStatus.BUDGET else Verdict.NO_PLAN)
    return Score(tuple(verdicts))


def score_document(workload: Workload, selection: Mapping[str, Any]) -> Score:
    """Score the content of a ``selection.json``."""
    pool = tuple(c.predicate for c in workload.columns)
    vocabulary = workload.vocabulary
    names = DeclaredNames(vocabulary.types, vocabulary.skills, (*vocabulary.initial, *pool))
    operators = [build_operator(OperatorDoc.model_validate(doc), names) for doc in selection["operators"]]
    return score_model(workload, selection["selected"], operators)


def execute(
    domain: PddlDomain, problem: PddlProblem, steps: Iterable[tuple[str, tuple[Object, ...]]]
) -> Verdict:  # fmt: skip
    """Carry out skills in the true domain, on sets of atoms.

    Where a skill has fewer arguments than the action, the state decides on the others.
    """
    state = problem.initial
    for skill, args in steps:
        action = next(_applicable(domain, problem, state, skill, args), None)
        if action is None:
            return Verdict.REFUSED
        state = action.apply(state)
    return Verdict.SOLVED if frozenset(problem.goal) <= state else Verdict.MISSED


def _applicable(
    domain: PddlDomain, problem: PddlProblem, state: AbstractState, skill: str, args: tuple[Object, ...]
) -> Iterator[GroundOperator]:
    for op in domain.operators:
        if op.skill.name != skill or not all(o.type.is_a(v.type) for o, v in zip(args, op.skill_args, strict=True)):
            continue
        bound = dict(zip(op.skill_args, args, strict=True))
        free = [v for v in op.parameters if v not in bound]
        others = [o for o in problem.objects if o not in args]
        for rest in groundings([v.type for v in free], others, distinct=True):
            binding = bound | dict(zip(free, rest, strict=True))
            action = op.ground(tuple(binding[v] for v in op.parameters))
            if action.applicable(state):
                yield action


@contextmanager
def _processor_time(seconds: float) -> Iterator[None]:
    """Raise ``TimeoutError`` in the block when this process has used ``seconds``."""

    def stop(signum: int, frame: FrameType | None) -> None:
        raise TimeoutError

    previous = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, previous)
