"""States that are alike up to the names of objects (orbit search; Pochter, Zohar and Rosenschein, AAAI 2011).

Two objects of one kind are interchangeable when exchanging them maps the task's operators and its goal onto themselves.
States that such exchanges make equal have as many plans of every length, so that one of them can stand for all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from pix2pred.planning.strips import Strips

Swap = tuple[tuple[int, int], ...]
"""Pairs of bits that change places."""


def interchangeable(task: Strips) -> Iterator[list[Swap]]:
    """Exchanges of any two objects, for each set of interchangeable objects of one kind; none without ``task.atoms``.

    Tasks with conditional effects or derived facts are not looked at.
    """
    mentioned = sorted({o for _, *objects in task.atoms for o in objects}) if type(task) is Strips else []
    test = _Exchange(task)
    while mentioned:
        first, *others = mentioned
        alike = [first] + [o for o in others if task.kinds[o] == task.kinds[first] and test.is_symmetry(first, o)]
        mentioned = [o for o in others if o not in alike]
        if swaps := [test.swap(a, b) or () for i, b in enumerate(alike) for a in alike[:i]]:
            yield swaps


class Orbits:
    """Names one state for all states that exchanges of objects make equal.

    The name is the smallest that exchanges one after another lead to, which need not be the smallest of all: then a few
    equal states keep apart. Facts about one set of objects change by themselves, so that they are looked up as a whole.
    """

    def __init__(self, task: Strips) -> None:
        self._sets: list[tuple[int, list[Swap], dict[int, int]]] = []
        for swaps in interchangeable(task):
            moved = 0
            for swap in swaps:
                for a, b in swap:
                    moved |= a | b
            self._sets.append((moved, swaps, {}))

    def __bool__(self) -> bool:
        return bool(self._sets)

    def name(self, state: int) -> int:
        """The same for ``state`` and most states like it."""
        for moved, swaps, known in self._sets:
            part = state & moved
            if part not in known:
                known[part] = _smallest(part, swaps)
            state ^= part ^ known[part]
        return state


def _smallest(part: int, swaps: Sequence[Swap]) -> int:
    """The smallest number that exchanges make of ``part``, each being made if it makes it smaller."""
    smaller = True
    while smaller:
        smaller = False
        for swap in swaps:
            other = _swapped(part, swap)
            if other < part:
                part, smaller = other, True
    return part


class _Exchange:
    """Exchanges of two objects in a task."""

    def __init__(self, task: Strips) -> None:
        self._task = task
        self._numbers = {atom: i for i, atom in enumerate(task.atoms)}
        self._about: dict[int, list[int]] = {}
        for i, (_, *objects) in enumerate(task.atoms):
            for o in objects:
                self._about.setdefault(o, []).append(i)
        costs = map(task.cost, range(len(task.pre)))
        self._operators = list(zip(task.pre, task.add, task.delete, costs, strict=True))

    def swap(self, a: int, b: int) -> Swap | None:
        """The pairs of facts that change places with ``a`` and ``b``; ``None`` when one of them is no fact here."""
        pairs = set()
        for i in {*self._about[a], *self._about[b]}:
            predicate, *objects = self._task.atoms[i]
            other = self._numbers.get((predicate, *(b if o == a else a if o == b else o for o in objects)))
            if other is None:
                return None
            if other != i:
                pairs.add((1 << min(i, other), 1 << max(i, other)))
        return tuple(sorted(pairs))

    def is_symmetry(self, a: int, b: int) -> bool:
        """Whether exchanging the two maps goal and operators onto themselves."""
        pairs = self.swap(a, b)
        if pairs is None or _swapped(self._task.goal, pairs) != self._task.goal:
            return False
        moved = 0
        for pair in pairs:
            moved |= pair[0] | pair[1]
        touched = Counter([o for o in self._operators if (o[0] | o[1] | o[2]) & moved])
        return all(touched[_mapped(operator, pairs)] == count for operator, count in touched.items())


def _mapped(operator: tuple[int, int, int, int], pairs: Swap) -> tuple[int, int, int, int]:
    pre, add, delete, cost = operator
    return _swapped(pre, pairs), _swapped(add, pairs), _swapped(delete, pairs), cost


def _swapped(mask: int, pairs: Swap) -> int:
    for a, b in pairs:
        if bool(mask & a) != bool(mask & b):
            mask ^= a | b
    return mask
