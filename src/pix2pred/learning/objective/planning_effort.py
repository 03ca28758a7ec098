"""What a stream of skeletons is worth: the expected planning effort of one demonstration (method 6.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from pix2pred.planning import Strips

P_REFINE = 1 - 1e-5
"""p: probability that a skeleton as long as the demonstration is the right one."""

UPPER_BOUND = 1e5
"""Charged in proportion to the probability that no skeleton was right."""

BACKTRACK = 1000.0
"""Charged for every skeleton after the first."""


@dataclass(frozen=True, slots=True)
class DemoScore:
    """J_d, or a lower bound on it when the search was stopped early (``exact`` False).

    ``charges`` is the part of J_d that is not nodes: back-tracks, and the charge for finding no right skeleton.
    ``budget_hit`` tells that the node budget ended the search.
    """

    value: float
    charges: float = 0.0
    exact: bool = True
    budget_hit: bool = False


class DemoObjective(Protocol):
    """A way to say what one demonstration adds to J. A new one is one file with one class."""

    @property
    def near_tie(self) -> float:
        """Difference of J, in nodes, within which two sets are equally good as far as this way of counting can tell."""
        ...

    def __call__(self, task: Strips | None, states: int, bound: float) -> DemoScore:
        """J_d of a demonstration of ``states`` states; ``task`` is None when the goal is unreachable.

        The computation may stop once J_d is certain to exceed ``bound``, and then gives a lower bound that does.
        """
        ...


@dataclass(slots=True)
class Effort:
    """The running sum J_d of one demonstration with ``states`` states, over at most ``max_plans`` skeletons."""

    states: int
    max_plans: int
    total: float = 0.0
    charges: float = 0.0
    left: float = 1.0
    count: int = 0

    def refinability(self, states: int) -> float:
        """Prior probability that a skeleton visiting ``states`` states is the right one."""
        return float(P_REFINE * (1 - P_REFINE) ** abs(self.states - states))

    def skeleton(self, states: int, nodes: float) -> None:
        """Account for the next skeleton, found when ``nodes`` nodes had been created."""
        q = self.refinability(states)
        charge = self.left * q * (BACKTRACK if self.count else 0.0)
        self.total += self.left * q * nodes + charge
        self.charges += charge
        self.left *= 1 - q
        self.count += 1

    def settled(self, shortest: int, nodes: float, epsilon: float) -> bool:
        """Whether skeletons of ``shortest`` states or more change J_d by less than ``epsilon`` (method 6.5, item 3)."""
        remaining = self.max_plans - self.count
        chance = min(1.0, remaining * self.refinability(max(self.states, shortest)))
        return remaining <= 0 or self.left * chance * max(UPPER_BOUND, nodes + BACKTRACK) < epsilon

    def at_least(self, nodes: float) -> float:
        """A lower bound on J_d: whatever skeleton comes next, ``nodes`` nodes were created before it."""
        return self.total + self.left * min(nodes, UPPER_BOUND)

    def finish(self, budget_hit: bool = False) -> DemoScore:
        """J_d once no further skeleton comes. What a search that ran out of nodes did not find is charged as
        nodes: it says nothing about the model."""
        rest = self.left * UPPER_BOUND
        return DemoScore(self.total + rest, self.charges + (0.0 if budget_hit else rest), budget_hit=budget_hit)


UNREACHABLE = DemoScore(UPPER_BOUND, UPPER_BOUND)
"""What a demonstration costs whose goal cannot be reached."""
