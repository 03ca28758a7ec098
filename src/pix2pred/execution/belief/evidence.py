"""Log odds of an atom, and what labels add to them."""

from __future__ import annotations

import math
from dataclasses import dataclass

LARGEST = 20.0
"""Log odds that stand for certainty: e^20 is far beyond any other evidence, and its products stay finite."""


def log_odds(probability: float) -> float:
    """The log odds of a probability, within ``LARGEST``."""
    if probability <= 0:
        return -LARGEST
    if probability >= 1:
        return LARGEST
    return max(-LARGEST, min(LARGEST, math.log(probability / (1 - probability))))


def probability_of(odds: float) -> float:
    """The probability with these log odds."""
    return 1 / (1 + math.exp(-max(-LARGEST, min(LARGEST, odds))))


def within(odds: float, bound: float) -> float:
    """``odds``, at most ``bound`` to either side."""
    return max(-bound, min(bound, odds))


@dataclass(frozen=True, slots=True)
class Answers:
    """What was said about one atom in one picture: how often true and how often false."""

    true: int = 0
    false: int = 0

    def plus(self, value: bool) -> Answers:
        """With one answer more."""
        return Answers(self.true + value, self.false + (not value))

    def log_odds(self, error: float, sticky: float) -> float:
        """What the answers show, when each is wrong with probability ``error``.

        With probability ``sticky`` an error belongs to the picture, and all answers are the same; else each answer is
        for itself. So equal answers add little to the first, and a single different one shows that answers differ.
        """
        return math.log(self._likelihood(True, error, sticky)) - math.log(self._likelihood(False, error, sticky))

    def _likelihood(self, value: bool, error: float, sticky: float) -> float:
        right, wrong = (self.true, self.false) if value else (self.false, self.true)
        alone = (1 - error) ** right * error**wrong
        if right and wrong:
            return (1 - sticky) * alone
        same = 1.0 if not right and not wrong else 1 - error if right else error
        return sticky * same + (1 - sticky) * alone
