"""The FF heuristic for 64 states at once.

Source of the heuristic: Hoffmann and Nebel, "The FF planning system", 2001. Every fact and every operator has a word
whose bit i belongs to state i, so that one operation on words is done for all states. Numpy is loaded with this module.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pix2pred.planning.heuristics.columns import Places, by_width
from pix2pred.planning.strips import Strips, bits

Words = NDArray[np.uint64]
"""Facts or ways; bit i of each belongs to state i."""

STATES = 64
"""States in a word."""

TIERS = 2
"""Ways with one precondition that does not hold yet are taken first, then those with so many, then all others."""

MAX_MEGABYTES = 400
"""What the layers of a relaxed plan may take: 50 layers of a million ways and facts."""

EVERY = np.uint64(2**64 - 1)


class TooDeepError(RuntimeError):
    """Relaxed plans have so many layers that those of 64 states take too much memory."""


@dataclass(frozen=True, slots=True)
class Evaluated:
    """For every state the length of a plan without deletes, -1 where there is none, and operators to try first."""

    estimates: list[int]
    preferred: list[list[int]]


@dataclass(frozen=True, slots=True)
class _Layers:
    """Facts true after each layer, beginning with the states themselves, and ways open before it."""

    facts: list[Words]
    open: list[Words]


class SlicedFF:
    """Lengths of plans without deletes from up to 64 states of ``task``, and their operators that apply at once.

    Of the ways to a fact in the first layer that has it, one is taken of which few preconditions are missing.
    """

    def __init__(self, task: Strips) -> None:
        task = task.without_static_facts()
        self._facts = task.facts
        self._operators = len(task.pre)
        self._goal = np.fromiter(bits(task.goal), np.intp)
        ways = sorted(task.relaxed(), key=lambda way: way[0].bit_count())
        self._operator_of = np.fromiter((min(k, self._operators) for _, _, k in ways), np.intp, len(ways))
        self._pre = by_width([pre for pre, _, _ in ways])
        pairs = sorted((fact, w) for w, (_, add, _) in enumerate(ways) for fact in bits(add))
        fact_of = np.fromiter((f for f, _ in pairs), np.intp, len(pairs))
        self._adding = np.fromiter((w for _, w in pairs), np.intp, len(pairs))
        self._added, starts = np.unique(fact_of, return_index=True)
        self._starts = starts.astype(np.intp)
        bounds = np.searchsorted(fact_of, np.arange(task.facts + 1))
        self._from, self._to = bounds[:-1], bounds[1:]

    def __call__(self, states: Sequence[int]) -> Evaluated:
        """Evaluate ``states``, at least one and at most 64. Raises ``TooDeepError``."""
        first = self._sliced(states)
        layers, alive = self._forward(first)
        chosen = self._backward(layers, alive)
        counted = np.flatnonzero(chosen[:-1])
        lengths = _unsliced(chosen[counted]).sum(axis=0)
        lives = _unsliced(np.array([alive]))[0]
        estimates = [int(n) if a else -1 for n, a in zip(lengths[: len(states)], lives, strict=False)]
        at_once = np.zeros_like(chosen)
        if layers.open:
            np.bitwise_or.at(at_once, self._operator_of, layers.open[0])
        preferred: list[list[int]] = [[] for _ in range(STATES)]
        rows, columns = np.nonzero(_unsliced(chosen[counted] & at_once[counted]))
        for k, state in zip(counted[rows].tolist(), columns.tolist(), strict=True):
            preferred[state].append(k)
        return Evaluated(estimates, preferred[: len(states)])

    def _sliced(self, states: Sequence[int]) -> Words:
        """The facts of ``states`` as words, which the last state fills up."""
        size = -(-self._facts // 8)
        filled = [*states, *[states[-1]] * (STATES - len(states))]
        raw = np.frombuffer(b"".join(s.to_bytes(size, "little") for s in filled), np.uint8).reshape(STATES, size)
        single = np.unpackbits(raw, axis=1, count=self._facts, bitorder="little")
        packed = np.packbits(np.ascontiguousarray(single.T), axis=1, bitorder="little")
        return packed.view(np.uint64).reshape(-1)

    def _forward(self, facts: Words) -> tuple[_Layers, np.uint64]:
        """Layers until every state has the goal or nothing new, and the states that have it."""
        layers = _Layers([facts], [])
        allowed = MAX_MEGABYTES * 2**20 // (8 * (len(facts) + len(self._operator_of)))
        while True:
            alive = np.bitwise_and.reduce(facts[self._goal]) if self._goal.size else EVERY
            if alive == EVERY:
                return layers, alive
            opened = np.full(len(self._operator_of), EVERY)
            for place, columns in self._pre:
                here = opened[place : place + len(columns[0])]
                for column in columns:
                    here &= facts.take(column, mode="clip")
            after = facts.copy()
            after[self._added] |= np.bitwise_or.reduceat(opened.take(self._adding, mode="clip"), self._starts)
            if np.array_equal(after, facts):
                return layers, alive
            if len(layers.open) >= allowed:
                raise TooDeepError
            layers.open.append(opened)
            layers.facts.append(after)
            facts = after

    def _backward(self, layers: _Layers, alive: np.uint64) -> Words:
        """The operators of plans without deletes, and a last word for what happens by itself."""
        chosen = np.zeros(self._operators + 1, np.uint64)
        want = np.zeros(self._facts, np.uint64)
        want[self._goal] = alive
        hard = self._hard(layers.facts[0]) if layers.open else []
        for n in reversed(range(len(layers.open))):
            here = want & layers.facts[n + 1] & ~layers.facts[n]
            rows = np.flatnonzero(here)
            ways, taken = self._achievers(rows, here[rows], layers.open[n], hard)
            np.bitwise_or.at(chosen, self._operator_of[ways], taken)
            for place, columns in self._pre:
                low, high = np.searchsorted(ways, (place, place + len(columns[0])))
                for column in columns if high > low else ():
                    np.bitwise_or.at(want, column[ways[low:high] - place], taken[low:high])
        return chosen

    def _hard(self, first: Words) -> list[Words]:
        """The ways of which more than one precondition is missing in a state, and more than two."""
        hard = [np.zeros(len(self._operator_of), np.uint64) for _ in range(TIERS)]
        missing = ~first
        for place, columns in self._pre:
            seen = np.zeros(len(columns[0]), np.uint64)
            tiers = [h[place : place + len(columns[0])] for h in hard]
            for column in columns:
                carry = missing.take(column, mode="clip")
                seen, carry = seen | carry, seen & carry
                for tier in tiers:
                    more = tier & carry
                    tier |= carry
                    carry = more
        return hard

    def _achievers(self, rows: Places, wanted: Words, opened: Words, hard: Sequence[Words]) -> tuple[Places, Words]:
        """Ways, ascending, that add the facts ``rows`` in the states that want them: one for each fact and state."""
        counts = self._to[rows] - self._from[rows]
        owner = np.repeat(np.arange(len(rows)), counts)
        pairs = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts - self._from[rows], counts)
        ways = self._adding[pairs]
        useful = opened[ways] & wanted[owner]
        kept = np.flatnonzero(useful)
        ways, owner, useful = ways[kept], owner[kept], useful[kept]
        left = wanted.copy()
        found: list[tuple[Places, Words]] = []
        for tier in (*hard, None):
            mine = useful & left[owner]
            if tier is not None:
                mine &= ~tier[ways]
            kept = np.flatnonzero(mine)
            found.append((ways[kept], _first(owner[kept], mine[kept], left)))
            if not left.any():
                break
        ways = np.concatenate([w for w, _ in found])
        taken = np.concatenate([t for _, t in found])
        order = np.argsort(ways, kind="stable")
        return ways[order], taken[order]


def _first(owner: Places, useful: Words, left: Words) -> Words:
    """``useful`` with the first row alone for every state and owner; what is found is taken from ``left``."""
    found = np.zeros_like(useful)
    if not owner.size:
        return found
    turn = np.flatnonzero(np.concatenate(([True], owner[1:] != owner[:-1])))
    ends = np.concatenate((turn[1:], [len(owner)]))
    mine = owner[turn]
    while turn.size:
        here = useful[turn] & left[mine]
        found[turn] = here
        left[mine] &= ~here
        turn = turn + 1
        going = (turn < ends) & (left[mine] != 0)
        turn, ends, mine = turn[going], ends[going], mine[going]
    return found


def _unsliced(words: Words) -> NDArray[np.uint8]:
    """A column of zeros and ones for every state."""
    return np.unpackbits(words.view(np.uint8).reshape(-1, 8), axis=1, bitorder="little")
