"""The nodes of A* as plateaus: all nodes with one value of f, equal (state, g) together with a multiplicity."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from heapq import heappop, heappush
from random import Random

import numpy as np

from pix2pred.planning import LMCut, Strips
from pix2pred.planning.symmetries import Orbits

Counts = dict[int, float]
"""Numbers of nodes per number of plateau ancestors ``e``."""

Node = tuple[int, int]
"""(g, state)."""

Child = tuple[int, int, int | None]
"""Number of equal children, their state, its estimate."""

DEEPEST = 400
"""Steps of a plan up to which goals are looked for depth first: Python's stack is the limit."""

SEED = 0
"""Of the tie-break values where a plateau is sampled."""

_T, _WEIGHT = np.polynomial.legendre.leggauss(48)
_TIMES = ((_T + 1) / 2) ** 2
_TIME_WEIGHTS = _WEIGHT / 2 * (_T + 1)
"""Gauss-Legendre nodes on [0, 1], denser towards 0 where the first of many goals is found."""


@dataclass(slots=True)
class Expanded:
    """What expanding all nodes of one f gives, per ``e``: goal nodes, expanded nodes, and nodes these created.

    ``later`` are the created nodes of larger f. ``nodes`` tree nodes were created in all, of which ``children`` had to
    be looked at, the others being copies.
    """

    goals: Counts = field(default_factory=lambda: defaultdict(float))
    expanded: Counts = field(default_factory=lambda: defaultdict(float))
    created: Counts = field(default_factory=lambda: defaultdict(float))
    later: dict[int, dict[Node, float]] = field(default_factory=dict)
    nodes: float = 0.0
    children: int = 0

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


class Plateaus:
    """Open nodes by f; ``nodes`` counts created tree nodes.

    Once ``symmetries_after`` states were looked at, states alike up to the names of objects count as one.
    """

    def __init__(self, task: Strips, symmetries_after: int) -> None:
        self._symmetries_after = symmetries_after
        self._task = task
        self._goal = task.goal
        self._operators, self._estimate = _without_copies(task)
        h = self._estimate(task.initial)
        self.open: dict[int, dict[Node, float]] = {} if h is None else {h: {(0, task.initial): 1.0}}
        self.nodes = 1.0
        self._known: dict[int, list[Child]] = {}
        self._orbits: Orbits | None = None
        self._first: dict[int, int] = {}

    def _children(self, state: int) -> list[Child]:
        """The different children of ``state``, looked at once."""
        if state not in self._known:
            if len(self._known) == self._symmetries_after:
                self._find_orbits()
            self._known[state] = self._look_at(state)
        return self._known[state]

    def _find_orbits(self) -> None:
        orbits = Orbits(self._task)
        if orbits:
            self._orbits = orbits
            for state in self._known:
                self._first.setdefault(orbits.name(state), state)

    def _look_at(self, state: int) -> list[Child]:
        missing = ~state
        after = self._estimate.after
        copies: dict[int, int] = {}
        estimates: list[int | None] = []
        name = self._orbits.name if self._orbits is not None else None
        for pre, add, keep, k, equal in self._operators:
            if not pre & missing:
                successor = state & keep | add
                if name is not None:  # the first that was seen stands for all like it
                    successor = self._first.setdefault(name(successor), successor)
                if successor in copies:
                    copies[successor] += equal
                else:
                    copies[successor] = equal
                    estimates.append(after(state, k, successor))
        return [(n, successor, h) for (successor, n), h in zip(copies.items(), estimates, strict=True)]

    def goals(self, f: int, wanted: float, most_states: int) -> float | None:
        """The number of goal nodes on the plateau of ``f``, or some number that is at least ``wanted``.

        Looks depth first and stops at ``wanted``, so that few states tell that a plateau has many goals. ``None`` when
        more than ``most_states`` states, or a plan of more than ``DEEPEST`` steps, would be needed to tell.
        """
        known: dict[Node, float] = {}

        def below(g: int, state: int) -> float:
            if not self._goal & ~state:
                return 1.0
            if (g, state) in known:
                return known[g, state]
            found = 0.0
            for copies, successor, h in self._children(state):
                if h is not None and g + 1 + h <= f:
                    found += copies * below(g + 1, successor)
                    if found >= wanted or len(known) > most_states:
                        break
            known[g, state] = found
            return found

        total = 0.0
        for (g, state), count in self.open[f].items():
            if f - g > DEEPEST:
                return None
            total += count * below(g, state)
            if total >= wanted:
                return total
            if len(known) > most_states:
                return None
        return total

    def expand(self, f: int, most_children: int, most_nodes: float) -> Expanded | None:
        """Expand every node of the plateau, which then is no longer open.

        ``None``, and nothing has happened, when its different nodes have more than ``most_children`` children, or when
        more than ``most_nodes`` tree nodes have been created in all before it is through.
        """
        plateau = Expanded()
        entries = self.open[f]
        lone = len(entries) == 1 and set(entries.values()) == {1.0}  # popped first whatever its tie-break value is
        by_g: dict[int, dict[int, Counts]] = defaultdict(dict)
        for (g, state), count in entries.items():
            by_g[g].setdefault(state, defaultdict(float))[0 if lone else 1] = count
        while by_g:
            g = min(by_g)
            for state, counts in by_g.pop(g).items():
                if plateau.children > most_children or self.nodes + plateau.nodes > most_nodes:
                    return None
                if not self._goal & ~state:
                    for e, count in counts.items():
                        plateau.goals[e] += count
                else:
                    self._expand_group(f, g, state, counts, plateau, by_g)
        del self.open[f]
        self.nodes += plateau.nodes
        for later_f, nodes in plateau.later.items():
            queue = self.open.setdefault(later_f, {})
            for node, count in nodes.items():
                queue[node] = queue.get(node, 0.0) + count
        return plateau

    def _expand_group(
        self, f: int, g: int, state: int, counts: Counts, plateau: Expanded, by_g: dict[int, dict[int, Counts]]
    ) -> None:
        """Put the children of equal nodes, ``counts`` of them per ``e``, on this plateau or a later one."""
        total = sum(counts.values())
        for e, count in counts.items():
            plateau.expanded[e] += count
        for copies, successor, h in self._children(state):
            plateau.nodes += copies * total
            plateau.children += 1
            for e, count in counts.items():
                plateau.created[e] += copies * count
            if h is None:
                continue
            child_f = g + 1 + h
            if child_f > f:
                later = plateau.later.setdefault(child_f, {})
                later[g + 1, successor] = later.get((g + 1, successor), 0.0) + copies * total
            else:  # popped at once when below f: at the same time as its parent
                child = by_g[g + 1].setdefault(successor, defaultdict(float))
                for e, count in counts.items():
                    child[e + (child_f == f)] += copies * count

    def sampled_nodes_at_first_goal(self, f: int, most_nodes: float, samples: int, most_created: int) -> float:
        """Nodes created on the plateau of ``f`` when its first goal is popped: the mean of searches with random ties.

        For plateaus too large to expand. There are ``samples`` searches, or fewer once they have created
        ``most_created`` nodes together; one that creates ``most_nodes`` without a goal ends there. The generator is
        seeded with a constant.
        """
        random = Random(SEED)
        found: list[float] = []
        while len(found) < samples and sum(found) < most_created:
            found.append(self._sampled_search(f, most_nodes, random.random))
        return sum(found) / len(found)

    def _sampled_search(self, f: int, most_nodes: float, random: Callable[[], float]) -> float:
        """One search. Of ``n`` equal nodes the tie-break values are drawn in ascending order, one at a time."""
        queue: list[tuple[float, int, int, int, float]] = []
        pushed = 0

        def push(least: float, g: int, state: int, count: float) -> None:
            nonlocal pushed
            pushed += 1
            tie = least + (1 - least) * (1 - (1 - random()) ** (1 / count))
            heappush(queue, (tie, pushed, g, state, count))

        for (g, state), count in self.open[f].items():
            push(0.0, g, state, count)
        created = 0.0
        while queue and created < most_nodes:
            tie, _, g, state, count = heappop(queue)
            if count > 1:
                push(tie, g, state, count - 1)
            if not self._goal & ~state:
                return created
            for copies, successor, h in self._children(state):
                created += copies
                if h is not None and g + 1 + h == f:
                    push(0.0, g + 1, successor, copies)
                elif h is not None and g + 1 + h < f:  # popped at once, all copies
                    heappush(queue, (-1.0, pushed, g + 1, successor, copies))
        return most_nodes


SearchOperator = tuple[int, int, int, int, int]
"""Preconditions, add effects, facts that are kept, number of the operator for the estimate, and how many are equal."""


def _without_copies(task: Strips) -> tuple[list[SearchOperator], LMCut]:
    """The operators of a task, equal ones once, and the estimate with those that differ in their deletes alone once.

    Facts that cannot matter were dropped, so that many instances have become equal. The estimate needs the deletes only
    to tell which facts can be lost, and its values are the same: equal operators are always in a landmark together.
    """
    counted = Counter(zip(task.pre, task.add, task.delete, strict=True))
    relaxed: dict[tuple[int, int], int] = {}
    deletes: list[int] = []
    operators = []
    for (pre, add, delete), copies in counted.items():
        k = relaxed.setdefault((pre, add & ~pre), len(relaxed))
        if k == len(deletes):
            deletes.append(0)
        deletes[k] |= delete
        operators.append((pre, add, ~delete, k, copies))
    pres, adds = tuple(pre for pre, _ in relaxed), tuple(add for _, add in relaxed)
    return operators, LMCut(Strips(task.facts, pres, adds, tuple(deletes), task.initial, task.goal))
