"""Plans from a state that is in doubt: one that rests on less, and one from the nearest state that has any."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass

from pix2pred.execution.belief.perception import Perception
from pix2pred.execution.explaining.rests import initial_needs
from pix2pred.structs import AbstractState, Atom, GroundOperator, PlanResult, PlanStatus, WhyAsked

CAUTION = 40.0
"""What resting on a wrong atom costs, in skills: a wrong step may lead where no learned operator leads away, and then
all that was done is lost. Tasks of the burger kitchen take 25 to 30 skills, and somebody has to clear up after them."""

SURE_OF_THE_GOAL = 0.99
"""How probable every atom of the goal has to be for a task to be left: what is left undone is lost, and the next step
brings another look."""

AS_LIKELY = 2.0
"""Atoms whose probabilities differ by no more than this factor are looked at together: the shorter plan decides."""

SAFER = 3
"""Plans looked at, each without what the one before it rests on in doubt."""


def safer_plan(
    plan_from: Callable[[AbstractState], PlanResult],
    goal: Collection[Atom],
    perception: Perception,
    plan: Sequence[GroundOperator],
    without: Collection[Atom],
) -> PlanResult | None:
    """A better plan, which works even if the atoms ``without``, which probably hold, do not; None if there is none.

    A plan costs its steps and what it risks: ``CAUTION`` times the probability that an atom in doubt on which it rests
    does not hold. That the goal seems to hold already is such a plan, too.
    """
    avoided = set(without)
    best: PlanResult | None = None
    least = _cost(plan, goal, perception)
    for _ in range(SAFER if avoided else 0):
        found = plan_from(perception.state - avoided)
        if found.status != PlanStatus.SOLVED:
            break
        if (cost := _cost(found.plan, found.goal or goal, perception)) <= least:
            best, least = found, cost
        more = _doubted(found.plan, found.goal or goal, perception)
        if avoided.issuperset(more):
            break
        avoided.update(more)
    return best


def unsure(atoms: Iterable[Atom], perception: Perception) -> Sequence[Atom]:
    """Those that seem to hold, but not surely enough to leave a task for it."""
    return [a for a in atoms if a in perception.state and perception.probability(a) < SURE_OF_THE_GOAL]


def _doubted(plan: Sequence[GroundOperator], goal: Iterable[Atom], perception: Perception) -> Sequence[Atom]:
    """What a plan rests on in doubt, taken for true."""
    if not plan:
        return unsure(goal, perception)
    return perception.doubts(initial_needs(plan, goal) & perception.state)


def _cost(plan: Sequence[GroundOperator], goal: Iterable[Atom], perception: Perception) -> float:
    holding = math.prod(perception.probability(a) for a in _doubted(plan, goal, perception))
    return len(plan) + CAUTION * (1 - holding)


@dataclass(frozen=True, slots=True)
class NearestPlan:
    """A plan that exists if the atoms ``assumed``, which are taken for false, hold; none when the belief changed."""

    found: PlanResult
    assumed: tuple[Atom, ...]


def nearest_plan(
    plan_from: Callable[[AbstractState], PlanResult], goals: Sequence[Sequence[Atom]], perception: Perception
) -> NearestPlan | None:
    """A plan from the nearest state that has one, after what differs was asked about; None when there is none.

    Preconditions are positive, so that there is a plan from some state in doubt if and only if there is one from the
    state in which all atoms hold that may hold. Of these the probable ones are tried first. That the goal itself holds
    in part is assumed only if nothing else helps, and that it holds altogether never: there would be nothing to do.
    Of several ``goals`` ``plan_from`` chooses.
    """
    wanted = {atom for goal in goals for atom in goal}
    for assumable in ([a for a in perception.possible() if a not in wanted], perception.possible()):
        nearest = _nearest_of(assumable, plan_from, goals[0], perception)
        if nearest is not None:
            return nearest if nearest.found.plan or not nearest.assumed else None
    return None


def _nearest_of(
    possible: Sequence[Atom],
    plan_from: Callable[[AbstractState], PlanResult],
    goal: Sequence[Atom],
    perception: Perception,
) -> NearestPlan | None:
    """The same for states that differ in some of the atoms ``possible`` alone."""
    asked = set[Atom]()
    while True:
        found = _resting_on_the_likeliest(possible, plan_from, goal, perception)
        if found is None:
            return None
        rests_on = initial_needs(found.plan, found.goal or goal)
        differ = tuple(a for a in possible if a in rests_on)
        if perception.ask(differ, WhyAsked.NO_PLAN):
            again = plan_from(perception.state)
            if again.status == PlanStatus.SOLVED:
                return NearestPlan(again, ())
        if asked.issuperset(differ):
            return NearestPlan(found, tuple(a for a in differ if a not in perception.state))
        asked.update(differ)  # the answers may have made others likelier
        possible = sorted(possible, key=perception.probability, reverse=True)


def _resting_on_the_likeliest(
    possible: Sequence[Atom],
    plan_from: Callable[[AbstractState], PlanResult],
    goal: Sequence[Atom],
    perception: Perception,
) -> PlanResult | None:
    """A plan that rests on those of ``possible`` that are the likeliest together, of a few that are looked at.

    What helps a few of them helps many, so that the fewest, from the first on, are found by bisection.
    """
    found = list[PlanResult]()

    def solved(count: int) -> bool:
        plan = plan_from(perception.state | set(possible[:count]))
        if plan.status == PlanStatus.SOLVED:
            found.append(plan)
        return plan.status == PlanStatus.SOLVED

    if not solved(len(possible)):
        return None
    too_few, enough = -1, len(possible)
    while enough - too_few > 1:
        count = (too_few + enough) // 2
        too_few, enough = (too_few, count) if solved(count) else (count, enough)
    if enough:
        least = perception.probability(possible[enough - 1]) / AS_LIKELY
        solved(sum(perception.probability(a) >= least for a in possible))

    def cost(result: PlanResult) -> float:
        assumed = initial_needs(result.plan, result.goal or goal) - perception.state
        return len(result.plan) + _unlikeliness(assumed, perception)

    return min(found, key=cost)


def _unlikeliness(assumed: Iterable[Atom], perception: Perception) -> float:
    """What it costs, in skills, to rest on atoms that are taken for false."""
    return -CAUTION * sum(math.log(perception.probability(a)) for a in sorted(assumed))


def simpler(found: PlanResult, unlikely: float, nearest: NearestPlan, perception: Perception) -> bool:
    """Whether a plan against which there are ``unlikely`` nats is to be preferred to one that rests on what is
    probably not so."""
    cost = len(nearest.found.plan) + _unlikeliness(nearest.assumed, perception)
    return len(found.plan) + CAUTION * unlikely < cost


def that_of(found: PlanResult, goals: Iterable[tuple[Atom, ...]]) -> list[tuple[Atom, ...]]:
    """``goals``, the one that ``found`` was planned for first."""
    return sorted(goals, key=lambda goal: goal != found.goal)
