"""Planning for one goal after the other: from where the plan for the goals before has led, the nearest open one next.

Goals that do not hinder each other are reached by plans that are as short as each of them allows, where one search for
all at once wanders. Sources of the idea: Koehler and Hoffmann, "On reasonable and forced goal orderings and their use
in an agenda-driven planning algorithm", 2000; Lipovetzky and Geffner, "Width and serialization of classical planning
problems", 2012.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pix2pred.planning.heuristics.ff import FF
from pix2pred.planning.heuristics.heuristic import Heuristic
from pix2pred.planning.heuristics.lmcut_costs import landmark_cut
from pix2pred.planning.search.astar import AStar
from pix2pred.planning.search.search import SearchResult
from pix2pred.planning.strips import Strips, bits
from pix2pred.structs import PlanStatus


class _LeadingOn(Heuristic):
    """The estimate for some goals; a state from which not all goals can be reached is a dead end."""

    def __init__(self, task: Strips, everything: Heuristic) -> None:
        self._estimate, self._everything = landmark_cut(task), everything

    def __call__(self, state: int) -> int | None:
        return None if self._everything(state) is None else self._estimate(state)

    def after(self, parent: int, k: int, state: int) -> int | None:
        return None if self._everything(state) is None else self._estimate.after(parent, k, state)


@dataclass(frozen=True, slots=True)
class OneByOne:
    """A* for the goals one by one; the status is BUDGET where that does not work.

    For tasks whose relaxed plan has ``least_steps`` and more, for which A* alone has too few nodes. The goal whose
    relaxed plan is shortest comes next, one that the way to another has undone included, up to twice as many times as
    there are goals; but one that would have to be undone for another goal comes after that: the eraser is put away when
    all is wiped. Each search gets ``each`` nodes, or fewer where nodes times operators would be more than
    ``visits``; states that are alike up to names of interchangeable objects are looked at once after
    ``symmetries_after`` nodes.
    """

    least_steps: int = 31
    each: int = 2_000
    visits: int = 2_000_000
    symmetries_after: int = 50

    def __call__(self, task: Strips) -> SearchResult:
        """Plan for the goals of ``task`` in turn."""
        if type(task) is not Strips or task.costs:  # what a part needs is not known, or the cheapest plan is wanted
            return SearchResult(PlanStatus.BUDGET, (), 0)
        everything = FF(task)
        estimate = everything(task.initial)
        if estimate is None:
            return SearchResult(PlanStatus.UNSOLVABLE, (), 1)
        near = {1 << fact: FF(replace(task, goal=1 << fact)) for fact in bits(task.goal)}
        state, nodes = task.initial, 1
        plan: list[int] = []
        waits_for: dict[int, int] = {}
        for _ in range(2 * len(near) if estimate >= self.least_steps else 0):
            if task.is_goal(state):
                break
            missing = task.goal & ~state
            ordered = sorted((g for g in near if g & missing), key=lambda g: (near[g](state) or 0, g))
            found, spent = self._next(task, state, ordered, waits_for, everything)
            nodes += spent
            if found is None:
                break
            plan += found.plan
            state = _after(task, state, found.plan)
        if not task.is_goal(state):
            return SearchResult(PlanStatus.BUDGET, (), nodes)
        return SearchResult(PlanStatus.SOLVED, tuple(plan), nodes)

    def _next(
        self, task: Strips, state: int, goals: Sequence[int], waits_for: dict[int, int], everything: Heuristic
    ) -> tuple[SearchResult | None, int]:
        """The plan for the first goal that need not be undone for another one, and the nodes of all that were made.

        What a goal waits for is remembered in ``waits_for``: it is not planned for again before that is reached. The
        plan for the first goal serves where every one waits for others.
        """
        first, nodes = None, 0
        missing = sum(goals)
        for goal in [g for g in goals if not waits_for.get(g, 0) & missing] or goals[:1]:
            found = self._plan(replace(task, initial=state, goal=goal), everything)
            nodes += found.nodes
            if found.status != PlanStatus.SOLVED:
                break
            after = _after(task, state, found.plan)
            waits_for[goal] = missing & ~after & ~_reachable_with(task, after, goal)
            if not waits_for[goal]:
                return found, nodes
            first = first or found
        return first, nodes

    def _plan(self, part: Strips, everything: Heuristic) -> SearchResult:
        """A shortest plan for a part of the goals, if need be the shortest that bars no other goal."""
        nodes = min(self.each, self.visits // max(1, len(part.pre)))
        found = AStar(landmark_cut, nodes, self.symmetries_after)(part)
        if everything(_after(part, part.initial, found.plan)) is not None:
            return found
        return AStar(lambda task: _LeadingOn(task, everything), nodes // 4, self.symmetries_after)(part)


def _reachable_with(task: Strips, state: int, kept: int) -> int:
    """What can be reached from ``state`` by steps that do not undo ``kept``, if nothing else is ever deleted."""
    reached = state
    waiting = [(pre, add) for pre, add, gone in zip(task.pre, task.add, task.delete, strict=True) if not gone & kept]
    grown = True
    while grown:
        still = []
        for pre, add in waiting:
            if pre & ~reached:
                still.append((pre, add))
            else:
                reached |= add
        grown = len(still) < len(waiting)
        waiting = still
    return reached


def _after(task: Strips, state: int, plan: Sequence[int]) -> int:
    for k in plan:
        state = task.successor(state, k)
    return state
