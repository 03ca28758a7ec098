"""Error rates and effects of predicates, estimated from labels by expectation maximisation (Baum-Welch; Rabiner 1989).

With free effects first; then each is settled as none, add, delete or mixed by the Bayesian information criterion.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning.labels.chains import Chains, Ints
from pix2pred.learning.labels.messages import Floats, backward, forward
from pix2pred.learning.operators.robust_settings import LabelModelSettings

TIE = 1e-6
"""Differences of beliefs and of log-likelihoods below it are rounding."""

UNCERTAIN = 1e-9
"""Guards logarithms and divisions of expected counts, which may be 0."""


class EffectKind(IntEnum):
    """What a class of transitions does to an atom in one role; ``MIXED`` is sometimes one thing, sometimes another."""

    NONE = 0
    ADD = 1
    DELETE = 2
    MIXED = 3


class BaumWelch:
    """Error rates per predicate and transition probabilities per (predicate, role), fitted to one block of chains.

    Roles 0 and 1 are the frame: no transition, and a transition that the atom is not about.
    """

    def __init__(
        self,
        chains: Chains,
        siblings: Ints,
        beyond: NDArray[np.bool_],
        settings: LabelModelSettings,
        guess: float,
        floor: float,
    ) -> None:
        self._chains = chains
        self._beyond = beyond
        self._settings = settings
        self._guess = guess
        self._floor = floor
        self._member: Floats = (siblings[:, None] == np.arange(siblings.max() + 1)).astype(float)
        n, roles = len(chains.predicates), len(siblings)
        self.rates: Floats = np.full(n, guess)
        self._up: Floats = np.full((n, roles), settings.first_change)
        self._down: Floats = np.full((n, roles), settings.first_change)
        self.effects = np.zeros((n, roles), dtype=np.int64)
        self._before: Floats = np.zeros((n, roles))
        self._unforeseen: Floats = np.zeros(n)
        self._fix_frame()
        self._index = chains.owner[:, None] * roles + chains.roles
        self._seen = chains.labels >= 0
        self._first: Floats = np.full(len(chains.owner), 0.5)
        self.values: NDArray[np.bool_] = chains.labels == 1
        self.belief: Floats = np.zeros(chains.labels.shape)

    def fit(self) -> None:
        """Estimate with free effects, then settle them."""
        settings = self._settings
        for _ in range(settings.free_rounds):
            counts = self._expect()
            siblings = self._of_siblings(counts)
            counts = counts + settings.sibling_weight * siblings / (siblings.sum((0, 1)) + 1)
            self._up, self._down = self._free(counts)
            self._fix_frame()
        free = self._up, self._down
        self._settle(self._expect(), mixed=False)
        self._settle_before()
        self._up, self._down = free  # that was a first opinion: what the next skill needs may overturn it
        for mixed in (*[False] * settings.unmixed_rounds, *[True] * settings.mixed_rounds):
            self._settle(self._expect(), mixed=mixed)
            self._expect()
            self._settle_before()
        self._expect()
        self.values = self.belief > 0.5 + TIE  # what no label says anything about counts as false
        labels = np.bincount(self._chains.owner, self._chains.weight * self._seen.sum(1), len(self.rates))
        self.surprise = self.rates + self._unforeseen / np.maximum(labels, 1)

    def _free(self, counts: Floats) -> tuple[Floats, Floats]:
        """Probabilities of change that are not settled, from expected counts."""
        imagined, total = self._settings.change_prior, self._settings.change_prior_total
        return (
            (counts[0, 1] + imagined) / (counts[0].sum(0) + total),
            (counts[1, 0] + imagined) / (counts[1].sum(0) + total),
        )

    def _fix_frame(self) -> None:
        self._up[:, :2] = self._down[:, :2] = self._settings.drift

    def _expect(self) -> Floats:
        """Update beliefs and error rates by forward and backward messages along every chain.

        Gives expected counts of shape (2, 2, predicates, roles): of value before, of value after.
        """
        like_true, like_false = self._likelihoods()
        up, down = self._up.ravel()[self._index], self._down.ravel()[self._index]
        ahead = forward(like_true, like_false, up, down, self._first)
        behind = backward(like_true, like_false, up, down)
        weight = ahead * behind
        self.belief = weight / (weight + (1 - ahead) * (1 - behind))
        self._estimate_rates()
        return self._expected_counts(ahead, behind, up, down, like_true, like_false)

    def _expected_counts(
        self, ahead: Floats, behind: Floats, up: Floats, down: Floats, like_true: Floats, like_false: Floats
    ) -> Floats:
        """How often, by predicate and role, a value was probably followed by a value."""
        before = (1 - ahead[:, :-1], ahead[:, :-1])
        after = (like_false[:, 1:] * (1 - behind[:, 1:]), like_true[:, 1:] * behind[:, 1:])
        step = ((1 - up, up), (down, 1 - down))
        joint = [[before[x] * step[x][y] * after[y] for y in (0, 1)] for x in (0, 1)]
        scale = self._chains.weight[:, None] / (joint[0][0] + joint[0][1] + joint[1][0] + joint[1][1])
        index, size = self._index.ravel(), self._up.size
        counts = [[np.bincount(index, (joint[x][y] * scale).ravel(), size) for y in (0, 1)] for x in (0, 1)]
        return np.array(counts).reshape(2, 2, *self._up.shape)

    def _likelihoods(self) -> tuple[Floats, Floats]:
        """How probable every label is if its atom is true, and if it is false; 1 where there is no label.

        What usually holds before a transition counts as evidence for the state before it.
        """
        chains, seen = self._chains, self._seen
        rate = np.maximum(self.rates, self._floor)[chains.owner][:, None]
        wrong_if_true = chains.labels == 0
        like_true = np.where(seen, np.where(wrong_if_true, rate, 1 - rate), 1.0)
        like_false = np.where(seen, np.where(wrong_if_true, 1 - rate, rate), 1.0)
        like_true[:, :-1] *= np.exp(self._before.ravel()[self._index])
        return like_true, like_false

    def _estimate_rates(self) -> None:
        wrong = np.where(self._chains.labels == 1, 1 - self.belief, self.belief) * self._seen
        n = len(self._chains.predicates)
        weight = self._chains.weight
        errors = np.bincount(self._chains.owner, weight * wrong.sum(1), n)
        labels = np.bincount(self._chains.owner, weight * self._seen.sum(1), n)
        imagined = self._settings.prior_labels
        rates = (errors + imagined * self._guess) / (labels + imagined)
        self.rates = np.clip(rates, self._settings.least_rate, self._settings.greatest_rate)

    def _of_siblings(self, counts: Floats) -> Floats:
        """Counts summed over roles that are siblings, at each of these roles."""
        return np.asarray(counts @ self._member @ self._member.T)

    def _settle(self, counts: Floats, *, mixed: bool) -> None:
        """Choose an effect in every role by penalised likelihood, ``MIXED`` only if ``mixed``."""
        settings = self._settings
        of_siblings = self._scores(self._of_siblings(counts))
        scores = self._scores(counts) + np.maximum(of_siblings - of_siblings.max(0), -settings.sibling_pull)
        stay0, rise, fall, stay1 = counts[0, 0], counts[0, 1], counts[1, 0], counts[1, 1]
        up, down = rise / np.maximum(stay0 + rise, UNCERTAIN), fall / np.maximum(stay1 + fall, UNCERTAIN)
        self.effects = np.argmax(scores if mixed else scores[: EffectKind.MIXED], axis=0)
        self.effects = np.where(self._beyond, np.argmax(scores, axis=0), self.effects)
        self.effects[:, :2] = EffectKind.NONE
        rare, usual = settings.slip, 1 - settings.slip
        self._up = np.choose(self.effects, [rare, usual, rare, np.clip(up, rare, usual)])
        self._down = np.choose(self.effects, [rare, rare, usual, np.clip(down, rare, usual)])
        if self._beyond.any():
            none = self._beyond & (self.effects == EffectKind.NONE)
            self._up = np.where(none, settings.unforeseen, self._up)
            self._down = np.where(none, settings.unforeseen, self._down)
        self._fix_frame()
        outcomes = np.minimum(np.minimum(stay0, rise) + np.minimum(stay1, fall), counts.sum((0, 1)))
        self._unforeseen = (outcomes * (self.effects == EffectKind.MIXED)).sum(1)

    def _scores(self, counts: Floats) -> Floats:
        """Log-likelihoods of the four kinds of effect in their order, less what each kind costs (BIC and penalties)."""
        settings = self._settings
        stay0, rise, fall, stay1 = counts[0, 0], counts[0, 1], counts[1, 0], counts[1, 1]
        slip = np.maximum(max(settings.slip, self._floor), self.rates)[:, None]
        miss, hit = np.log(slip), np.log(1 - slip)
        parameter = 0.5 * np.log(counts.sum((0, 1)) + 1)
        change = parameter + settings.change_penalty
        scores: Floats = np.stack([
            (rise + fall) * miss + (stay0 + stay1) * hit,
            (stay0 + fall) * miss + (rise + stay1) * hit - change,
            (stay1 + rise) * miss + (fall + stay0) * hit - change,
            _log_likelihood(stay0, rise) + _log_likelihood(stay1, fall) - 2 * parameter - settings.mixed_penalty,
        ])  # fmt: skip
        return scores

    def _settle_before(self) -> None:
        """Where an atom is always, or never, true before a transition, as far as its wrong labels allow to say (BIC).

        An atom that a transition deletes is expected to hold before it, one that it adds is not.
        """
        evidence = np.log(self.belief[:, :-1]) - np.log1p(-self.belief[:, :-1]) - self._before.ravel()[self._index]
        true = 1 / (1 + np.exp(-np.clip(evidence, -30, 30)))
        index, size, weight = self._index.ravel(), self._before.size, self._chains.weight[:, None]

        def by_role(values: Floats) -> Floats:
            sums: Floats = np.bincount(index, (weight * values).ravel(), size).astype(np.float64)
            return sums

        total = by_role(np.ones_like(true))
        share = by_role(true) / np.maximum(total, 1)
        for _ in range(self._settings.custom_rounds):
            weighted = share[self._index] * true
            share = by_role(weighted / (weighted + (1 - share[self._index]) * (1 - true))) / np.maximum(total, 1)
        mixture = share[self._index] * true + (1 - share[self._index]) * (1 - true)
        effects = self.effects.ravel()
        expected = np.log(self._settings.precondition_odds)
        scores = np.stack([
            by_role(np.log(mixture)) - 0.5 * np.log(total + 1),
            by_role(np.log(true)) + expected * (effects == EffectKind.DELETE),
            by_role(np.log1p(-true)) + expected * (effects == EffectKind.ADD),
        ])  # fmt: skip
        nothing_said = abs(scores[1] - scores[2]) < TIE  # labels that are all missing are no reason for either
        settled = np.where(nothing_said, 0, np.argmax(scores, axis=0))
        custom = float(np.log(self._settings.custom_odds))
        self._before = np.choose(settled, [0.0, custom, -custom]).reshape(self._before.shape)
        self._before[:, :2] = 0.0


def _log_likelihood(a: Floats, b: Floats) -> Floats:
    """Maximal log-likelihood of ``a`` and ``b`` (expected) outcomes of two kinds."""
    n = np.maximum(a + b, UNCERTAIN)
    likelihood: Floats = a * np.log(np.maximum(a, UNCERTAIN) / n) + b * np.log(np.maximum(b, UNCERTAIN) / n)
    return likelihood
