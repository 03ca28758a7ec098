"""J_d by expected counts: nodes with equal (state, g) are one node with a multiplicity (method 6.6).

A* with uniformly random ties works through plateaus: all nodes with one value of f. A node of a plateau is popped when
its tie-break value comes up, at a time t in [0, 1], but not before its parent. A node with ``e`` plateau nodes on
its path, itself included, is therefore popped by time t with probability t^e. From the number of goal nodes and of
created nodes per ``e`` follow the expected numbers of nodes created when skeletons are found: the goal's own ancestors
have been expanded for certain, all other nodes with the probability above. Two approximations are made:
ancestors that different nodes share are counted as if they were not shared, and skeletons after a plateau's first are
spaced evenly over the rest of it (their weight in J_d is 1e-5 or less).
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from pix2pred.learning.objective.planning_effort import UNREACHABLE, DemoScore, Effort
from pix2pred.planning import LMCut, Strips

Counts = dict[int, float]
"""Numbers of nodes per number of plateau ancestors ``e``."""

_T, _WEIGHT = np.polynomial.legendre.leggauss(48)
_TIMES = ((_T + 1) / 2) ** 2
_TIME_WEIGHTS = _WEIGHT / 2 * (_T + 1)
"""Gauss-Legendre nodes on [0, 1], denser towards 0 where the first of many goals is found."""


@dataclass(slots=True)
class _Plateau:
    """What expanding all nodes of one f gives, per ``e``: goal nodes, expanded nodes, and nodes these created."""

    goals: Counts = field(default_factory=lambda: defaultdict(float))
    expanded: Counts = field(default_factory=lambda: defaultdict(float))
    created: Counts = field(default_factory=lambda: defaultdict(float))

    def nodes_at_first_goal(self) -> float:
        """Expected number of nodes created on this plateau when its first goal node is popped."""
        no_goal = np.ones_like(_TIMES)
        for e, count in self.goals.items():
            no_goal *= (1 - _TIMES**e) ** count
        expected = 0.0
        for e, count in self.created.items():
            by_chance = 1.0 if e == 0 else float(np.sum(_TIME_WEIGHTS * e * _TIMES ** (e - 1) * no_goal))
            certain = min(1.0, 1 / self.expanded[e]) if e < min(self.goals) else 0.0
            expected += count * (certain + (1 - certain) * by_chance)
        return expected


@dataclass(frozen=True, slots=True)
class ExpectedNodes:
    """Deterministic, and cheap where many operator sequences pass through few states.

    ``epsilon`` is how much of J_d may be left uncounted when the search stops; ``node_budget`` bounds created nodes.
    """

    max_plans: int
    node_budget: int
    epsilon: float = 0.01
    near_tie: float = 1.0

    def __call__(self, task: Strips | None, states: int, bound: float) -> DemoScore:
        if task is None:
            return UNREACHABLE
        search = _PlateauSearch(task)
        effort = Effort(states, self.max_plans)
        while search.plateaus:
            f = min(search.plateaus)
            if effort.settled(f + 1, search.nodes, self.epsilon):
                break
            if effort.at_least(search.nodes) > bound:
                return DemoScore(effort.at_least(search.nodes), exact=False)
            if search.nodes > self.node_budget:
                return effort.finish(budget_hit=True)
            start = search.nodes
            plateau = search.expand(f, self.node_budget)
            if plateau is None:
                return effort.finish(budget_hit=True)
            if plateau.goals:
                first = start + plateau.nodes_at_first_goal()
                if first > self.node_budget:
                    return effort.finish(budget_hit=True)
                self._account(effort, f + 1, sum(plateau.goals.values()), first, search.nodes)
        return effort.finish()

    def _account(self, effort: Effort, states: int, goals: float, first: float, last: float) -> None:
        """Feed ``goals`` skeletons to ``effort``, found evenly between ``first`` and ``last`` created nodes."""
        number = int(min(goals, effort.max_plans - effort.count))
        for i in range(number):
            if effort.left < 1e-30:
                effort.count += number - i
                return
            effort.skeleton(states, first + (last - first) * i / goals)


class _PlateauSearch:
    """Open nodes by f, each a (g, state) with a multiplicity; ``nodes`` counts created tree nodes."""

    def __init__(self, task: Strips) -> None:
        self._task = task
        self._estimate = LMCut(task)
        h = self._estimate(task.initial)
        self.plateaus: dict[int, dict[tuple[int, int], float]] = {} if h is None else {h: {(0, task.initial): 1.0}}
        self.nodes = 1.0

    def expand(self, f: int, max_groups: int) -> _Plateau | None:
        """Expand every node of the plateau; ``None`` when it holds more than ``max_groups`` distinct ones."""
        task, estimate = self._task, self._estimate
        plateau = _Plateau()
        entries = self.plateaus.pop(f)
        lone = len(entries) == 1 and set(entries.values()) == {1.0}
        by_g: dict[int, dict[int, Counts]] = defaultdict(dict)
        for (g, state), count in entries.items():
            by_g[g].setdefault(state, defaultdict(float))[0 if lone else 1] = count
        groups = 0
        while by_g:
            g = min(by_g)
            for state, counts in by_g.pop(g).items():
                groups += 1
                if groups > max_groups:
                    return None
                if not task.goal & ~state:
                    for e, count in counts.items():
                        plateau.goals[e] += count
                    continue
                total = sum(counts.values())
                for e, count in counts.items():
                    plateau.expanded[e] += count
                for k in task.applicable(state):
                    successor = task.successor(state, k)
                    self.nodes += total
                    for e, count in counts.items():
                        plateau.created[e] += count
                    h = estimate.after(state, k, successor)
                    if h is None:
                        continue
                    child_f = g + 1 + h
                    if child_f > f:
                        later = self.plateaus.setdefault(child_f, {})
                        later[g + 1, successor] = later.get((g + 1, successor), 0.0) + total
                    else:  # popped at once when below f: at the same time as its parent
                        child = by_g[g + 1].setdefault(successor, defaultdict(float))
                        for e, count in counts.items():
                            child[e + (child_f == f)] += count
        return plateau
