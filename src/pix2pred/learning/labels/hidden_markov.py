"""Repairing labels along demonstrations: a two-state hidden Markov model per ground atom.

The true value of an atom is hidden, its label is wrong with the predicate's error rate, and what a transition does to
the value depends on the transition's class and on the place the atom's objects take in it, and on nothing else. Error
rates and effects are estimated together by expectation maximisation (Baum-Welch) over all demonstrations; then every
effect is settled as none, add, delete or mixed by the Bayesian information criterion, and the labels are replaced by
the most probable values (Rabiner 1989). A missing label says nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning.operators.clustering import Partition
from pix2pred.learning.operators.roles import Bystanders, Places
from pix2pred.learning.transitions import NOTHING, Data, Extension, ObjectIds

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SLIP = 1e-3
"""Probability that a transition's effect on an atom among its variables is not the settled one."""

DRIFT = 1e-4
"""Probability that a transition changes an atom that is not among its variables."""

FIRST_GUESS = 0.05
"""Error rate with which estimation starts; also the weak prior's mean."""

PRIOR_LABELS = 20.0
"""How many labels the pooled error rate counts for in the estimate of one predicate's."""

ROUNDS_FREE = 6
"""Rounds of estimation before effects are settled."""

CELLS = 1 << 18
"""Labels treated at a time, which bounds memory."""

EXPECTED = float(np.log(19))
"""Log odds that a deleted atom is a precondition, before looking."""

CUSTOM = float(np.log(99))
"""Log odds that an atom has the value it always has before a transition."""

PULL = 3.0
"""How much, at most, the effects of a skill's other classes count, as log odds."""

NONE, ADD, DELETE, MIXED = range(4)


@dataclass(frozen=True, slots=True)
class Repaired:
    """The most probable values of the noisy predicates, with what the model believes about them.

    ``extensions[p][demo][state]`` are the argument tuples; ``doubt[p][demo, state, args]`` is the probability that the
    atom is true where that is not near 0 or 1; ``effects[p][c, variables]`` is ADD, DELETE or MIXED, where variables
    beyond those of the class are ``bystanders`` (see ``Places``); ``surprise[p]`` is the share of labels that are wrong
    or the outcome of a mixed effect that mostly goes the other way.
    """

    extensions: dict[int, list[list[Extension]]]
    doubt: dict[int, dict[tuple[int, int, ObjectIds], float]]
    effects: dict[int, dict[tuple[int, tuple[int, ...]], int]]
    surprise: dict[int, float]
    bystanders: Bystanders


def repair(data: Data, classes: Partition, noisy: Sequence[int]) -> Repaired:
    """Estimate errors and effects of the predicates ``noisy``, given classes of transitions made without them."""
    bystanders = Bystanders.of(data)
    places = Places(data, classes, bystanders, noisy)
    result = Repaired({}, {}, {}, {}, bystanders)
    guess, floor = FIRST_GUESS, 0.0
    blocks = list(_blocks(data, places, noisy))
    for _ in range(2):  # the second time with the pooled error rate of the first as the prior and the least assumed
        rates: dict[int, float] = {}
        for chains in blocks:
            model = _Model(chains, places.kin(), guess, floor)
            model.fit()
            rates.update(zip(chains.predicates, model.rates.tolist(), strict=True))
            result.surprise.update(zip(chains.predicates, model.surprise.tolist(), strict=True))
            model.store(data, places, result)
        guess = floor = float(np.clip(np.median(list(rates.values())), 1e-3, FIRST_GUESS)) if rates else guess
    return result


@dataclass(frozen=True, slots=True)
class _Chains:
    """Labels and places of ground atoms, one row each; rows of a predicate are together.

    ``labels`` has shape (atoms, states), -1 where there is none; ``places`` has shape (atoms, states - 1).
    """

    predicates: list[int]
    owner: Ints
    where: list[tuple[int, ObjectIds]]
    labels: NDArray[np.int8]
    places: NDArray[np.int32]


def _blocks(data: Data, places: Places, noisy: Sequence[int]) -> Iterator[_Chains]:
    states = max((demo.states for demo in data.demos), default=0)
    rows: list[tuple[int, int, ObjectIds]] = []
    for p in noisy:
        for d, demo in enumerate(data.demos):
            atoms = places.touched(d, p).union(*(data.extension(d, s, p) for s in range(demo.states)))
            atoms |= set().union(*(data.unknown(d, s, p) for s in range(demo.states)))
            rows.extend((p, d, args) for args in sorted(atoms))
        if len(rows) * states >= CELLS:
            yield _chains(data, places, rows, states)
            rows = []
    if rows:
        yield _chains(data, places, rows, states)


def _chains(data: Data, places: Places, rows: Sequence[tuple[int, int, ObjectIds]], states: int) -> _Chains:
    predicates = sorted({p for p, _, _ in rows})
    number = {p: i for i, p in enumerate(predicates)}
    labels = np.full((len(rows), states), -1, dtype=np.int8)
    where = np.zeros((len(rows), max(states - 1, 0)), dtype=np.int32)
    index = {row: i for i, row in enumerate(rows)}
    for i, (p, d, args) in enumerate(rows):
        labels[i, : data.demos[d].states] = 0
        where[i, : data.demos[d].states - 1] = places.row(d, args, p)
    for p in predicates:
        for d, demo in enumerate(data.demos):
            for s in range(demo.states):
                for args in data.extension(d, s, p):
                    labels[index[p, d, args], s] = 1
                for args in data.unknown(d, s, p):
                    labels[index[p, d, args], s] = -1
    owner = np.array([number[p] for p, _, _ in rows], dtype=np.int64)
    return _Chains(predicates, owner, [(d, args) for _, d, args in rows], labels, where)


class _Model:
    """Error rates per predicate and transition probabilities per (predicate, place), fitted to one block."""

    def __init__(self, chains: _Chains, kin: Ints, guess: float, floor: float) -> None:
        self._chains = chains
        self._guess = guess
        self._floor = floor
        self._member: Floats = (kin[:, None] == np.arange(kin.max() + 1)).astype(float)
        n, places = len(chains.predicates), len(kin)
        self.rates: Floats = np.full(n, guess)
        self._up: Floats = np.full((n, places), 0.2)
        self._down: Floats = np.full((n, places), 0.2)
        self.effects = np.zeros((n, places), dtype=np.int64)
        self._before: Floats = np.zeros((n, places))
        self._unforeseen: Floats = np.zeros(n)
        self._fix_frame()
        self._index = chains.owner[:, None] * places + chains.places
        self._seen = chains.labels >= 0
        self.values: NDArray[np.bool_] = chains.labels == 1
        self.belief: Floats = np.zeros(chains.labels.shape)

    def fit(self) -> None:
        """Estimate with free effects, then settle them."""
        for _ in range(ROUNDS_FREE):
            counts = self._expect()
            counts = counts + 2 * self._of_kin(counts) / (self._of_kin(counts).sum((0, 1)) + 1)
            self._up = (counts[0, 1] + 0.2) / (counts[0].sum(0) + 1.0)
            self._down = (counts[1, 0] + 0.2) / (counts[1].sum(0) + 1.0)
            self._fix_frame()
        free = self._up, self._down
        self._settle(self._expect(), MIXED)
        self._settle_before()
        self._up, self._down = free  # that was a first opinion: what the next skill needs may overturn it
        for choices in (MIXED, MIXED, MIXED + 1, MIXED + 1):
            self._settle(self._expect(), choices)
            self._expect()
            self._settle_before()
        self._expect()
        self.values = self.belief > 0.5
        labels = np.bincount(self._chains.owner, self._seen.sum(1), len(self.rates))
        self.surprise = self.rates + self._unforeseen / np.maximum(labels, 1)

    def _fix_frame(self) -> None:
        self._up[:, :2] = self._down[:, :2] = DRIFT

    def _expect(self) -> Floats:
        """Beliefs, error rates, and expected counts of shape (2, 2, predicates, places) of value before and after."""
        chains, seen = self._chains, self._seen
        rate = np.maximum(self.rates, self._floor)[chains.owner][:, None]
        wrong_if_true = chains.labels == 0
        like_true = np.where(seen, np.where(wrong_if_true, rate, 1 - rate), 1.0)
        like_false = np.where(seen, np.where(wrong_if_true, 1 - rate, rate), 1.0)
        like_true[:, :-1] *= np.exp(self._before.ravel()[self._index])
        up, down = self._up.ravel()[self._index], self._down.ravel()[self._index]
        atoms, states = chains.labels.shape
        ahead: Floats = np.empty((atoms, states))
        behind: Floats = np.full((atoms, states), 0.5)
        prior: Floats | float = 0.5
        for s in range(states):
            if s:
                prior = ahead[:, s - 1] * (1 - down[:, s - 1]) + (1 - ahead[:, s - 1]) * up[:, s - 1]
            true, false = prior * like_true[:, s], (1 - prior) * like_false[:, s]
            ahead[:, s] = true / (true + false)
        for s in range(states - 2, -1, -1):
            if_true, if_false = like_true[:, s + 1] * behind[:, s + 1], like_false[:, s + 1] * (1 - behind[:, s + 1])
            true = (1 - down[:, s]) * if_true + down[:, s] * if_false
            false = up[:, s] * if_true + (1 - up[:, s]) * if_false
            behind[:, s] = true / (true + false)
        weight = ahead * behind
        self.belief = weight / (weight + (1 - ahead) * (1 - behind))
        self._estimate_rates()
        before = np.stack([1 - ahead[:, :-1], ahead[:, :-1]])
        step = np.stack([np.stack([1 - up, up]), np.stack([down, 1 - down])])
        after = np.stack([like_false[:, 1:] * (1 - behind[:, 1:]), like_true[:, 1:] * behind[:, 1:]])
        joint = before[:, None] * step * after[None]
        joint /= joint.sum((0, 1))
        size = self._up.size
        counts = [[np.bincount(self._index.ravel(), joint[x, y].ravel(), size) for y in (0, 1)] for x in (0, 1)]
        return np.array(counts).reshape(2, 2, *self._up.shape)

    def _estimate_rates(self) -> None:
        wrong = np.where(self._chains.labels == 1, 1 - self.belief, self.belief) * self._seen
        n = len(self._chains.predicates)
        errors = np.bincount(self._chains.owner, wrong.sum(1), n)
        labels = np.bincount(self._chains.owner, self._seen.sum(1), n)
        self.rates = np.clip((errors + PRIOR_LABELS * self._guess) / (labels + PRIOR_LABELS), 1e-4, 0.45)

    def _of_kin(self, counts: Floats) -> Floats:
        """Counts summed over places of the same kin, at each of these places."""
        return np.asarray(counts @ self._member @ self._member.T)

    def _settle(self, counts: Floats, choices: int) -> None:
        """Choose among the first ``choices`` effects at every place by penalised likelihood."""
        kindred = self._scores(self._of_kin(counts))
        scores = self._scores(counts) + np.maximum(kindred - kindred.max(0), -PULL)
        stay0, rise, fall, stay1 = counts[0, 0], counts[0, 1], counts[1, 0], counts[1, 1]
        up, down = rise / np.maximum(stay0 + rise, 1e-9), fall / np.maximum(stay1 + fall, 1e-9)
        self.effects = np.argmax(scores[:choices], axis=0)
        self.effects[:, :2] = NONE
        self._up = np.choose(self.effects, [SLIP, 1 - SLIP, SLIP, np.clip(up, SLIP, 1 - SLIP)])
        self._down = np.choose(self.effects, [SLIP, SLIP, 1 - SLIP, np.clip(down, SLIP, 1 - SLIP)])
        self._fix_frame()
        outcomes = np.minimum(np.minimum(stay0, rise) + np.minimum(stay1, fall), counts.sum((0, 1)))
        self._unforeseen = (outcomes * (self.effects == MIXED)).sum(1)

    def _scores(self, counts: Floats) -> Floats:
        """Penalised log-likelihoods of NONE, ADD, DELETE and MIXED."""
        stay0, rise, fall, stay1 = counts[0, 0], counts[0, 1], counts[1, 0], counts[1, 1]
        slip = np.maximum(max(SLIP, self._floor), self.rates)[:, None]
        miss, hit = np.log(slip), np.log(1 - slip)
        penalty = 0.5 * np.log(counts.sum((0, 1)) + 1)
        scores: Floats = np.stack([
            (rise + fall) * miss + (stay0 + stay1) * hit,
            (stay0 + fall) * miss + (rise + stay1) * hit - penalty - 1,
            (stay1 + rise) * miss + (fall + stay0) * hit - penalty - 1,
            _log_likelihood(stay0, rise) + _log_likelihood(stay1, fall) - 2 * penalty - 3,
        ])  # fmt: skip
        return scores

    def _settle_before(self) -> None:
        """Where an atom is always, or never, true before a transition, as far as its wrong labels allow to say (BIC).

        An atom that a transition deletes is expected to hold before it, one that it adds is not.
        """
        evidence = np.log(self.belief[:, :-1]) - np.log1p(-self.belief[:, :-1]) - self._before.ravel()[self._index]
        true = 1 / (1 + np.exp(-np.clip(evidence, -30, 30)))
        index, size = self._index.ravel(), self._before.size

        def by_place(values: Floats) -> Floats:
            sums: Floats = np.bincount(index, values.ravel(), size).astype(np.float64)
            return sums

        total = by_place(np.ones_like(true))
        share = by_place(true) / np.maximum(total, 1)
        for _ in range(10):
            weighted = share[self._index] * true
            share = by_place(weighted / (weighted + (1 - share[self._index]) * (1 - true))) / np.maximum(total, 1)
        mixture = share[self._index] * true + (1 - share[self._index]) * (1 - true)
        effects = self.effects.ravel()
        scores = np.stack([
            by_place(np.log(mixture)) - 0.5 * np.log(total + 1),
            by_place(np.log(true)) + EXPECTED * (effects == DELETE),
            by_place(np.log1p(-true)) + EXPECTED * (effects == ADD),
        ])  # fmt: skip
        settled = np.argmax(scores, axis=0)
        self._before = np.choose(settled, [0.0, CUSTOM, -CUSTOM]).reshape(self._before.shape)
        self._before[:, :2] = 0.0

    def store(self, data: Data, places: Places, result: Repaired) -> None:
        """Put values, doubts and effects of this block's predicates into ``result``."""
        chains = self._chains
        for i, p in enumerate(chains.predicates):
            result.extensions[p] = [[NOTHING] * demo.states for demo in data.demos]
            result.doubt[p] = {}
            result.effects[p] = {places.keys[k]: int(self.effects[i, k]) for k in np.flatnonzero(self.effects[i])}
        columns: dict[tuple[int, int, int], list[ObjectIds]] = {}
        for i, s in np.argwhere(self.values & self._inside()):
            d, args = chains.where[i]
            columns.setdefault((chains.predicates[chains.owner[i]], d, int(s)), []).append(args)
        for (p, d, s), found in columns.items():
            result.extensions[p][d][s] = frozenset(found)
        for i, s in np.argwhere((abs(self.belief - 0.5) < 0.4999) & self._inside()):
            d, args = chains.where[i]
            result.doubt[chains.predicates[chains.owner[i]]][d, int(s), args] = float(self.belief[i, s])

    def _inside(self) -> NDArray[np.bool_]:
        lengths = np.concatenate([self._chains.places > 0, np.zeros((len(self._chains.labels), 1), bool)], axis=1)
        inside = lengths.copy()
        inside[:, 1:] |= lengths[:, :-1]
        inside[:, 0] = True
        return inside


def _log_likelihood(a: Floats, b: Floats) -> Floats:
    """Maximal log-likelihood of ``a`` and ``b`` (expected) outcomes of two kinds."""
    n = np.maximum(a + b, 1e-9)
    likelihood: Floats = a * np.log(np.maximum(a, 1e-9) / n) + b * np.log(np.maximum(b, 1e-9) / n)
    return likelihood
