"""From scores to probabilities, when the labels they are measured on are sometimes wrong themselves.

A label is true with probability ``error + (1 - 2 error) / (1 + exp(-slope (score - middle)))``: a logistic curve for
the truth (Platt 1999), seen through a teacher who errs at one rate whatever is shown. The curve alone is what a reader
says; the rate is what it found out about its teacher. Few labels leave many curves possible, whose mean is taken: where
they differ, it is less sure than the most probable of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

ERRORS = np.array([0.0, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.14])
"""Rates of the teacher's errors that are tried."""
SLOPES = np.geomspace(1.0, 14.0, 14)
MIDDLES = np.linspace(-0.8, 0.8, 33)
"""Scores are about +1 and -1: the curves that are tried lie between flat and a step, anywhere in between."""
SCORES = np.linspace(-2.0, 2.0, 41)
"""Where a mean of curves is noted; beyond them it is what it is at the last of them."""
_COST_OF_ERROR = 4.0
"""Logarithm of likelihood that a rate of 1 would cost: a belief that teachers are mostly right."""
_USUAL_SLOPE, _SLOPE_DEVIATION, _MIDDLE_DEVIATION = 5.0, 1.0, 0.4
"""What is believed of curves before any label is seen: logarithm of the slope, and the middle."""
_LEAST = 1e-9


@dataclass(frozen=True, slots=True)
class Calibration:
    """The curve from a score to the probability that an atom is true.

    The most probable curve is a sigmoid of ``slope`` around ``middle``; ``error`` is the teacher's rate of wrong labels
    and ``most`` the highest probability that is ever claimed. ``odds`` are the logarithms of the odds at ``SCORES`` of
    the mean of all curves, lines in between; readers made before it was taken have those of the most probable one.
    """

    slope: float
    middle: float
    error: float
    most: float
    odds: Floats

    def probabilities(self, scores: Floats) -> Floats:
        """The probability of true, for each score."""
        return np.clip(_logistic(np.interp(scores, SCORES, self.odds)), 1 - self.most, self.most)

    def probability(self, score: float) -> float:
        """The probability of true."""
        return float(self.probabilities(np.array([score]))[0])

    def truth(self, scores: Floats, labels: Bools) -> Floats:
        """The probability of true when the teacher's label is known as well."""
        p = self.probabilities(scores)
        error = max(self.error, _LEAST)
        yes, no = p * np.where(labels, 1 - error, error), (1 - p) * np.where(labels, error, 1 - error)
        return yes / (yes + no)


@dataclass(frozen=True, slots=True)
class Fit:
    """The mean of the probable curves, and how well the most probable one foretells the labels.

    ``by_label`` holds logarithms of likelihood, weighted; ``prior`` is the logarithm of how much its curve is believed.
    """

    curve: Calibration
    by_label: Floats
    prior: float


def calibrate(scores: Floats, labels: Bools, weights: Floats) -> Fit:
    """The curve for scores of examples that were held out, with the rate of wrong labels among them."""
    p = _logistic(SLOPES[:, None, None] * (scores - MIDDLES[:, None]))
    right = np.where(labels, p, 1 - p)
    likely = np.stack([np.log(np.maximum(e + (1 - 2 * e) * right, _LEAST)) @ weights for e in ERRORS])
    prior = (
        -((np.log(SLOPES / _USUAL_SLOPE) / _SLOPE_DEVIATION) ** 2)[:, None] / 2 - (MIDDLES / _MIDDLE_DEVIATION) ** 2 / 2
    )
    total = likely + prior - _COST_OF_ERROR * ERRORS[:, None, None]
    e, s, m = np.unravel_index(int(total.argmax()), total.shape)
    most = 1 - 1 / (len(labels) + 2)  # Laplace's rule: so many cases show no more
    curve = Calibration(float(SLOPES[s]), float(MIDDLES[m]), float(ERRORS[e]), most, _mean(total.max(axis=0)))
    own = np.log(np.maximum(ERRORS[e] + (1 - 2 * ERRORS[e]) * right[s, m], _LEAST)) * weights
    believed = float(prior[s, m] - _COST_OF_ERROR * ERRORS[e])
    return Fit(curve, own, believed)


def _mean(total: Floats) -> Floats:
    """Log odds at ``SCORES`` of the mean curve, from logarithms of how probable curves are: (slopes, middles)."""
    probable = np.exp(total - total.max())
    p = np.tensordot(probable / probable.sum(), _logistic(SLOPES[:, None, None] * (SCORES - MIDDLES[:, None])), 2)
    odds: Floats = np.round(np.log(np.maximum(p, _LEAST) / np.maximum(1 - p, _LEAST)), 3)
    return odds


def _logistic(x: Floats) -> Floats:
    found: Floats = 1 / (1 + np.exp(-np.clip(x, -30, 30)))
    return found
