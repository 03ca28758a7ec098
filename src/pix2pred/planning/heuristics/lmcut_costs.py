"""The landmark-cut heuristic for any costs (Helmert and Domshlak, "Landmarks, critical paths and abstractions", 2009).

Round after round: h-max is computed with what operators still cost; the operators that lead into the facts from which
the goal costs nothing more are a landmark, one of which every plan contains; the least of their costs is added to the
estimate and taken off each of them.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from math import inf

from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.heuristics.lmcut import LMCut
from pix2pred.planning.strips import Strips, bits


def landmark_cut(task: Strips) -> Heuristic:
    """The landmark-cut heuristic for ``task``: the faster one where all operators cost one."""
    return CostLMCut(task) if task.costs else LMCut(task)


class CostLMCut(Heuristic):
    """Admissible estimate of what the cheapest plan from a state costs; ``None`` for a dead end."""

    def __init__(self, task: Strips) -> None:
        task = task.without_static_facts()
        self._goal_fact, self._always = task.facts, task.facts + 1
        self._ways = [(self._facts(pre), tuple(bits(add)), k) for pre, add, k in task.relaxed()]
        last = max([len(task.pre), *(k + 1 for *_, k in self._ways)])
        self._ways.append((self._facts(task.goal), (self._goal_fact,), last))
        self._costs = [*(task.cost(k) for k in range(len(task.pre))), *[0] * (last + 1 - len(task.pre))]
        self._needing: dict[int, list[int]] = defaultdict(list)
        self._adding: dict[int, list[int]] = defaultdict(list)
        for way, (pre, add, _) in enumerate(self._ways):
            for fact in pre:
                self._needing[fact].append(way)
            for fact in add:
                self._adding[fact].append(way)
        self._known: dict[int, int | None] = {}

    def __call__(self, state: int) -> int | None:
        if state not in self._known:
            self._known[state] = self._estimate((*bits(state), self._always))
        return self._known[state]

    def _facts(self, mask: int) -> tuple[int, ...]:
        """The facts of ``mask``; the one that always holds where there are none."""
        return tuple(bits(mask)) or (self._always,)

    def _estimate(self, state: tuple[int, ...]) -> int | None:
        costs = self._costs.copy()
        total = 0
        while True:
            reached_at, supporter = self._h_max(state, costs)
            if self._goal_fact not in reached_at:
                return None
            if reached_at[self._goal_fact] == 0:
                return total
            zone = self._goal_zone(supporter, costs)
            cut = self._cut(state, zone, supporter)
            least = min(costs[k] for k in cut)
            total += least
            for k in cut:
                costs[k] -= least

    def _h_max(self, state: tuple[int, ...], costs: list[int]) -> tuple[dict[int, int], list[int]]:
        """What each fact costs at least (its dearest precondition counts), and each way's dearest precondition."""
        reached_at: dict[int, int] = {}
        missing = [len(pre) for pre, _, _ in self._ways]
        supporter = [-1] * len(self._ways)
        queue = [(0, fact) for fact in state]
        best = dict.fromkeys(state, 0)
        while queue:
            value, fact = heapq.heappop(queue)
            if fact in reached_at:
                continue
            reached_at[fact] = value
            for way in self._needing[fact]:
                missing[way] -= 1
                if missing[way]:
                    continue
                supporter[way] = fact  # the last to be reached is the dearest
                _, add, k = self._ways[way]
                after = value + costs[k]
                for added in add:
                    if after < best.get(added, inf):
                        best[added] = after
                        heapq.heappush(queue, (after, added))
        return reached_at, supporter

    def _goal_zone(self, supporter: list[int], costs: list[int]) -> set[int]:
        """Facts from which the goal follows for nothing."""
        zone = {self._goal_fact}
        waiting = [self._goal_fact]
        while waiting:
            for way in self._adding[waiting.pop()]:
                fact = supporter[way]
                if fact >= 0 and fact not in zone and not costs[self._ways[way][2]]:
                    zone.add(fact)
                    waiting.append(fact)
        return zone

    def _cut(self, state: tuple[int, ...], zone: set[int], supporter: list[int]) -> set[int]:
        """Operators that lead from the state's side of the justification graph into the goal zone."""
        supported: dict[int, list[int]] = defaultdict(list)
        for way, fact in enumerate(supporter):
            supported[fact].append(way)
        seen = set(state)
        waiting = list(state)
        cut = set()
        while waiting:
            for way in supported[waiting.pop()]:
                _, add, k = self._ways[way]
                if not zone.isdisjoint(add):
                    cut.add(k)
                    continue
                for fact in add:
                    if fact not in seen:
                        seen.add(fact)
                        waiting.append(fact)
        return cut
