"""From scores to probabilities, when the labels they are measured on are sometimes wrong themselves.

A label is true with probability ``error + (1 - 2 error) / (1 + exp(-slope (score - middle)))``: a logistic curve for
the truth (Platt 1999), seen through a teacher who errs at one rate whatever is shown. The curve alone is what a reader
says; the rate is what it found out about its teacher.
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
_COST_OF_ERROR = 4.0
"""Logarithm of likelihood that a rate of 1 would cost: a belief that teachers are mostly right."""
_USUAL_SLOPE, _SLOPE_DEVIATION, _MIDDLE_DEVIATION = 5.0, 1.0, 0.4
"""What is believed of curves before any label is seen: logarithm of the slope, and the middle."""
_LEAST = 1e-9


@dataclass(frozen=True, slots=True)
class Calibration:
    """The curve from a score to the probability that an atom is true.

    It is a sigmoid of ``slope`` around ``middle``; ``error`` is the teacher's rate of wrong labels, and ``most`` the
    highest probability that is ever claimed.
    """

    slope: float
    middle: float
    error: float
    most: float

    def probabilities(self, scores: Floats) -> Floats:
        """The probability of true, for each score."""
        return np.clip(_logistic(self.slope * (scores - self.middle)), 1 - self.most, self.most)

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
    """The most probable curve, and the logarithm of how probable it makes the labels."""

    curve: Calibration
    likelihood: float


def calibrate(scores: Floats, labels: Bools, weights: Floats) -> Fit:
    """The most probable curve for scores of examples that were held out, with the rate of wrong labels among them."""
    p = _logistic(SLOPES[:, None, None] * (scores - MIDDLES[:, None]))
    right = np.where(labels, p, 1 - p)
    likely = np.stack([np.log(np.maximum(e + (1 - 2 * e) * right, _LEAST)) @ weights for e in ERRORS])
    prior = (
        -((np.log(SLOPES / _USUAL_SLOPE) / _SLOPE_DEVIATION) ** 2)[:, None] / 2 - (MIDDLES / _MIDDLE_DEVIATION) ** 2 / 2
    )
    total = likely + prior - _COST_OF_ERROR * ERRORS[:, None, None]
    e, s, m = np.unravel_index(int(total.argmax()), total.shape)
    most = 1 - 1 / (len(labels) + 2)  # Laplace's rule: so many cases show no more
    return Fit(Calibration(float(SLOPES[s]), float(MIDDLES[m]), float(ERRORS[e]), most), float(total[e, s, m]))


def _logistic(x: Floats) -> Floats:
    found: Floats = 1 / (1 + np.exp(-np.clip(x, -30, 30)))
    return found
