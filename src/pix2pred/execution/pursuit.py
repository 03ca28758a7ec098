"""Following a plan: which step comes next and when to plan again, given what is seen (method 8.5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from pix2pred.execution.monitor import necessary_atoms
from pix2pred.structs import AbstractState, Atom, GroundOperator, PlanResult, PlanStatus

MAX_REPLANS = 30


class GivenUpError(RuntimeError):
    """There is nothing left to try; ``stuck`` when a skill failed again in a state that looks the same."""

    def __init__(self, why: str, *, stuck: bool = False) -> None:
        super().__init__(why)
        self.stuck = stuck


@dataclass(slots=True)
class Pursuit:
    """A plan being followed; made anew when the atoms that its rest needs do not hold in what is seen.

    ``position`` is the number of its steps executed, ``replans`` how often it was made anew.
    """

    plan_from: Callable[[AbstractState], PlanResult]
    goal: Sequence[Atom]
    plan: Sequence[GroundOperator]
    max_replans: int = MAX_REPLANS
    position: int = 0
    replans: int = 0
    _failures: set[tuple[AbstractState, str]] = field(default_factory=set)

    def next(self, seen: AbstractState) -> GroundOperator | None:
        """The step to execute now; None when the goal seems to hold.

        Raises ``GivenUpError`` when no plan is found any more, or after ``max_replans`` new plans.
        """
        needed = necessary_atoms(self.plan, self.goal)[self.position]
        if not needed <= seen:
            if self.replans >= self.max_replans:
                raise GivenUpError(f"gave up after planning again {self.replans} times")
            found = self.plan_from(seen)
            self.replans += 1
            if found.status != PlanStatus.SOLVED:
                missing = ", ".join(str(a) for a in sorted(needed - seen)[:3])
                raise GivenUpError(f"no plan any more ({found.status}) after {missing} turned out not to hold")
            self.plan, self.position = found.plan, 0
        return self.plan[self.position] if self.position < len(self.plan) else None

    def executed(self, action: str, before: AbstractState, *, succeeded: bool) -> None:
        """The step was tried in the state ``before``. Raises ``GivenUpError`` when it failed there once already."""
        if not succeeded:
            if (before, action) in self._failures:
                raise GivenUpError(f"{action} failed again in a state that looks the same", stuck=True)
            self._failures.add((before, action))
        self.position += 1
