"""Forward and backward messages along two-state chains, all chains at once (Rabiner 1989).

Arrays have a row per chain and a column per state; ``up`` and ``down`` a column per transition: the probabilities that
false becomes true, and true false.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def forward(like_true: Floats, like_false: Floats, up: Floats, down: Floats, first: Floats) -> Floats:
    """The probability that every atom is true in every state, given its labels up to this state.

    ``first`` has the probability that it is true in the first state, before its label is seen.
    """
    ahead: Floats = np.empty(like_true.shape)
    prior = first
    for s in range(like_true.shape[1]):
        if s:
            prior = ahead[:, s - 1] * (1 - down[:, s - 1]) + (1 - ahead[:, s - 1]) * up[:, s - 1]
        true, false = prior * like_true[:, s], (1 - prior) * like_false[:, s]
        ahead[:, s] = true / (true + false)
    return ahead


def backward(like_true: Floats, like_false: Floats, up: Floats, down: Floats) -> Floats:
    """The share that "true" has in the likelihood of all labels after a state, against "false"."""
    behind: Floats = np.full(like_true.shape, 0.5)
    for s in range(like_true.shape[1] - 2, -1, -1):
        if_true, if_false = like_true[:, s + 1] * behind[:, s + 1], like_false[:, s + 1] * (1 - behind[:, s + 1])
        true = (1 - down[:, s]) * if_true + down[:, s] * if_false
        false = up[:, s] * if_true + (1 - up[:, s]) * if_false
        behind[:, s] = true / (true + false)
    return behind
