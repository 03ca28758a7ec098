"""J_d by expected counts: nodes with equal (state, g) are one node with a multiplicity (method 6.6).

A* with uniformly random ties works through plateaus: all nodes with one value of f. A node of a plateau is popped when
its tie-break value comes up, at a time t in [0, 1], but not before its parent. A node with ``e`` plateau nodes on
its path, itself included, is therefore popped by time t with probability t^e. From the number of goal nodes and of
created nodes per ``e`` follow the expected numbers of nodes created when skeletons are found: the goal's own ancestors
have been expanded for certain, all other nodes with the probability above. Two approximations are made:
ancestors that different nodes share are counted as if they were not shared, and skeletons after a plateau's first are
spaced evenly over the rest of it (their weight in J_d is 1e-5 or less).

A plateau whose different nodes have more than ``exact_children`` children is not expanded for its exact counts. How
many goals it has, up to what matters, is found depth first; when the first is found, by a few searches with random
ties. Where it has too few goals to end the search it is left as soon as the node budget is certain to be exceeded.
"""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.learning.objective.planning_effort import UNREACHABLE, DemoScore, Effort
from pix2pred.learning.objective.plateaus import Expanded, Plateaus
from pix2pred.planning import Strips

NEGLIGIBLE = 1e-30
"""Probability that no skeleton was right so far, below which further ones are counted but not accounted for."""


@dataclass(frozen=True, slots=True)
class ExpectedNodes:
    """Deterministic, and cheap where many operator sequences pass through few states.

    - ``max_plans`` skeletons at most are considered, ``node_budget`` tree nodes at most created.
    - ``epsilon`` is how much of J_d may be left uncounted when the search stops, in nodes.
    - A plateau is expanded for its exact counts if its different nodes have at most ``exact_children`` children.
    - Of a larger one at most ``most_children`` are looked at; more count as a budget hit, since a search would create
      many nodes for each of them.
    - When its first goal is found is the mean of ``samples`` searches that create some ``most_sampled`` nodes at most.
    - ``symmetries_after``: states looked at before interchangeable objects are looked for, which takes about as long.
    - ``near_tie``: see ``DemoObjective``.
    """

    max_plans: int
    node_budget: int
    epsilon: float = 0.01
    exact_children: int = 10_000
    most_children: int = 50_000
    samples: int = 16
    most_sampled: int = 20_000
    symmetries_after: int = 100
    near_tie: float = 1.0

    def __call__(self, task: Strips | None, states: int, bound: float) -> DemoScore:
        if task is None:
            return UNREACHABLE
        search = Plateaus(task, self.symmetries_after)
        effort = Effort(states, self.max_plans)
        while search.open:
            f = min(search.open)
            if effort.settled(f + 1, search.nodes, self.epsilon):
                break
            if effort.at_least(search.nodes) > bound:
                return DemoScore(effort.at_least(search.nodes), exact=False)
            if search.nodes > self.node_budget:
                return effort.finish(budget_hit=True)
            if abs(f + 1 - states) > 1 and self._ends_here(search, effort, f):
                break  # skeletons this far from the demonstration's length weigh 1e-10 or less
            start = search.nodes
            plateau = search.expand(f, self.exact_children, float("inf"))
            if plateau is None:
                if self._ends_here(search, effort, f, states):
                    return self._sampled(search, effort, f, self.samples if f + 1 == states else 1)
                plateau = search.expand(f, self.most_children, self.node_budget)
            if plateau is None or not self._account(effort, f, plateau, start, search.nodes):
                return effort.finish(budget_hit=True)
        return effort.finish()

    def _ends_here(self, search: Plateaus, effort: Effort, f: int, states: int = -1) -> bool:
        """Whether the plateau of ``f`` certainly has as many goals as are still considered.

        One is enough where plans have the right length: no further one counts for more than 1e-5.
        """
        wanted = 1 if f + 1 == states else self.max_plans - effort.count
        goals = search.goals(f, wanted, self.most_children)
        return goals is not None and goals >= wanted

    def _sampled(self, search: Plateaus, effort: Effort, f: int, samples: int) -> DemoScore:
        """J_d when all skeletons left are found on a large plateau, about when its first is."""
        left = self.node_budget - search.nodes
        first = search.nodes + search.sampled_nodes_at_first_goal(f, left, samples, self.most_sampled)
        if first >= self.node_budget:
            return effort.finish(budget_hit=True)
        self._skeletons(effort, f + 1, self.max_plans, first, first)
        return effort.finish()

    def _account(self, effort: Effort, f: int, plateau: Expanded, start: float, end: float) -> bool:
        """Account for the goals of an expanded plateau; whether the first was found within the node budget."""
        if not plateau.goals:
            return True
        first = start + plateau.nodes_at_first_goal()
        if first > self.node_budget:
            return False
        self._skeletons(effort, f + 1, sum(plateau.goals.values()), first, end)
        return True

    def _skeletons(self, effort: Effort, states: int, goals: float, first: float, last: float) -> None:
        """Feed ``goals`` skeletons to ``effort``, found evenly between ``first`` and ``last`` created nodes."""
        number = int(min(goals, effort.max_plans - effort.count))
        for i in range(number):
            if effort.left < NEGLIGIBLE:
                effort.count += number - i
                return
            effort.skeleton(states, first + (last - first) * i / goals)
