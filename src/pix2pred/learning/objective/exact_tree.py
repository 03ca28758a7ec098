"""J_d by the search of method 6.2 to the letter: A* over operator sequences, without a closed list."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np

from pix2pred.learning.objective.planning_effort import UNREACHABLE, DemoScore, Effort
from pix2pred.planning import LMCut, Strips


@dataclass(frozen=True, slots=True)
class ExactTree:
    """Ties are broken by a random number drawn at every push from a generator seeded with ``seed``.

    Dead ends are counted as created but never queued, and the search stops when what can still come changes J_d by less
    than ``epsilon``: neither changes the value by more (method 6.5, items 2 and 3).
    """

    max_plans: int
    node_budget: int
    seed: int = 0
    epsilon: float = 1e-4
    near_tie: float = 0.0

    def __call__(self, task: Strips | None, states: int, bound: float) -> DemoScore:
        if task is None:
            return UNREACHABLE
        estimate = LMCut(task)
        tie = np.random.default_rng(self.seed)
        effort = Effort(states, self.max_plans)
        draws: list[float] = []
        h = estimate(task.initial)
        queue = [] if h is None else [(h, 0.0, 0, 0, task.initial)]
        nodes = 1
        while queue:
            f, _, _, g, state = heapq.heappop(queue)
            if effort.settled(f + 1, nodes, self.epsilon):
                break
            if not task.goal & ~state:
                effort.skeleton(g + 1, nodes)
                continue
            if effort.at_least(nodes) > bound:
                return DemoScore(effort.at_least(nodes), exact=False)
            if nodes > self.node_budget:
                return effort.finish(budget_hit=True)
            for k in task.applicable(state):
                successor = task.successor(state, k)
                nodes += 1
                if (h := estimate(successor)) is not None:
                    if not draws:
                        draws = tie.random(1024).tolist()
                    heapq.heappush(queue, (g + 1 + h, draws.pop(), nodes, g + 1, successor))
        return effort.finish()
