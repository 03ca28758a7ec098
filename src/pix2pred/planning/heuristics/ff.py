"""The FF heuristic and its helpful operators (Hoffmann and Nebel, "The FF planning system", 2001)."""

from __future__ import annotations

from pix2pred.planning.heuristics.heuristic import Evaluation, Heuristic
from pix2pred.planning.strips import Strips, bits


class FF(Heuristic):
    """Length of a delete-free plan from a state. Preferred are the operators of that plan that apply at once."""

    def __init__(self, task: Strips) -> None:
        task = task.without_static_facts()
        self._task = task
        self._operators = [
            (pre, add & ~pre, k) for k, (pre, add) in enumerate(zip(task.pre, task.add, strict=True)) if add & ~pre
        ]

    def __call__(self, state: int) -> int | None:
        found = self.evaluate(state)
        return None if found is None else found.estimate

    def evaluate(self, state: int) -> Evaluation | None:
        achiever = self._explore(state)
        if achiever is None:
            return None
        plan = 0
        helpful = 0
        open_facts = list(bits(self._task.goal & ~state))
        wanted = self._task.goal
        while open_facts:
            k = achiever[open_facts.pop()]
            if plan >> k & 1:
                continue
            plan |= 1 << k
            needs = self._task.pre[k] & ~state
            if not needs:
                helpful |= 1 << k
            open_facts.extend(bits(needs & ~wanted))
            wanted |= needs
        return Evaluation(plan.bit_count(), helpful)

    def _explore(self, state: int) -> dict[int, int] | None:
        """The first operator to achieve each fact, layer by layer, until the goal is reached."""
        goal = self._task.goal
        reached = state
        achiever: dict[int, int] = {}
        waiting = self._operators
        while goal & ~reached:
            layer = reached
            still = []
            for operator in waiting:
                pre, add, k = operator
                if pre & ~layer:
                    still.append(operator)
                    continue
                for fact in bits(add & ~reached):
                    achiever[fact] = k
                reached |= add
            if reached == layer:
                return None
            waiting = still
        return achiever
