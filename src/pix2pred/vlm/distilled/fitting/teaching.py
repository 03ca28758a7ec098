"""Teaching one word: which kernel fits it best, what it says about demonstrations left out, and its probabilities.

Kernel ridge regression on labels of +1 and -1, both values weighing alike. Leaving demonstrations out needs no second
fit: with A = K + D, the score of a left-out block is its labels minus the solution of A^-1's block for its weights
(Rasmussen and Williams 2006, 5.4.2). What was left out has no say in the choice of the kernel that scores it either:
the best of many kernels on few labels is better there than on what comes later.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pix2pred.vlm.distilled.calibration import Calibration, calibrate
from pix2pred.vlm.distilled.machine import Compared, Kernel, Layout, Rows, WordMachine
from pix2pred.vlm.distilled.model import joint
from pix2pred.vlm.distilled.sight import Array

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]

RIDGES = (0.03, 0.2, 1.0)
"""Variances of labels about scores that are tried; codes have a variance of about 1."""
MIXTURES = ((1.0, 1.0), (0.5, 4.0), (0.0, 4.0), (0.0, 1.0))
"""Share of the linear kernel and squared length of the Gaussian one, in units of the mean squared distance of rows."""
_LEAST_MASS = 1e-3
_MOST_TRIED = 600
"""Rows on which kernels are compared; the chosen one is fitted to all."""
_ROUNDS, _CHOSEN_AGAIN = 4, 2
"""Times that labels are replaced by how probably they are true, given what the reader makes of all the others, and that
a kernel is chosen for them."""


@dataclass(frozen=True, slots=True)
class WordRows:
    """The rows that a word has labels for: their indices among all, and what is known of each.

    ``unit`` numbers what is answered as one: the same objects in all pictures of a look. Changed copies of a row come
    after the rows themselves and have their unit; ``originals`` says which are none.
    """

    rows: Ints
    labels: Bools
    weights: Floats
    folds: Ints
    units: Ints
    originals: Bools

    def part(self, kept: Bools) -> WordRows:
        """The rows with a true value in ``kept``."""
        return WordRows(
            self.rows[kept], self.labels[kept], self.weights[kept], self.folds[kept], self.units[kept],
            self.originals[kept],
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class TaughtWord:
    """A word's machine and curve, and its scores for what was left out, one for each unit with its label."""

    machine: WordMachine
    calibration: Calibration
    units: Ints
    scores: Floats
    labels: Bools


def teach(rows: Rows, mine: WordRows, rng: np.random.Generator) -> TaughtWord:
    """The best machine for one word, of the kernels and ridges that are tried."""
    chosen = _sample(mine, rng)
    tried = mine.part(chosen)
    own, few = _among_themselves(rows, mine), _among_themselves(rows, tried)
    candidates = list(_candidates(few.rows))
    truth = mine.labels.astype(np.float64)
    for number in range(_ROUNDS):
        if number < _CHOSEN_AGAIN:
            best, without = _choice([_quality(few, tried, truth[chosen], *candidate) for candidate in candidates])
        scores, weights = _left_out(own, mine, truth, *candidates[best])
        for other in sorted(set(without.values()) - {best}):
            elsewhere = np.isin(mine.folds, [fold for fold, choice in without.items() if choice == other])
            scores[elsewhere] = _left_out(own, mine, truth, *candidates[other])[0][elsewhere]
        units, joined, labels, trust = _by_unit(mine, scores)
        calibration = calibrate(joined, labels, trust).curve
        known = dict(zip(units.tolist(), calibration.truth(joined, labels), strict=True))
        truth = np.array([known[int(unit)] for unit in mine.units])
    everywhere = np.zeros(len(rows.codes), dtype=np.float32)
    everywhere[mine.rows] = weights
    return TaughtWord(WordMachine(candidates[best][0], everywhere), calibration, units, joined, labels)


def _choice(qualities: Sequence[Mapping[int, float]]) -> tuple[int, dict[int, int]]:
    """The best candidate, and by fold the best of all other folds. A quality is a sum over folds; -1 is no fold."""
    table = np.array([list(quality.values()) for quality in qualities])
    total = table.sum(axis=1)
    folds = list(qualities[0])
    return int(total.argmax()), {f: int((total - table[:, i]).argmax()) for i, f in enumerate(folds) if f >= 0}


def _among_themselves(rows: Rows, mine: WordRows) -> Compared:
    own = rows.codes[mine.rows]
    return Compared(own, Rows(rows.layout, own))


def _candidates(rows: Rows) -> Iterator[tuple[Kernel, float]]:
    for parts in _choices_of_parts(rows.layout):
        usual = _usual_distance(rows, parts)
        for (linear, scale), ridge in product(MIXTURES, RIDGES):
            yield Kernel(linear, scale * usual, parts), ridge


def _choices_of_parts(layout: Layout) -> list[tuple[str, ...]]:
    """All parts; all but where things are; and shapes and colours of the objects alone.

    Where an object has company: this with all else, with where the object is, and not at all.
    """
    everything, own = layout.parts, layout.own
    placeless = tuple(p for p in own if not p.endswith(".place"))
    close = tuple(p for p in placeless if not p.endswith(".around"))
    around = tuple(p for p in everything if p not in placeless)
    return list(dict.fromkeys((own, placeless, close, *((everything, around) if own != everything else ()))))


def _usual_distance(rows: Rows, parts: Sequence[str]) -> float:
    return max(1e-3, float(2 * rows.codes.astype(np.float64).var(axis=0) @ rows.layout.mean_of(parts)))


def _sample(mine: WordRows, rng: np.random.Generator) -> Bools:
    """At most so many rows, whole units with their copies."""
    units = rng.permutation(np.unique(mine.units))
    share = min(1.0, _MOST_TRIED / len(mine.rows))
    kept = np.isin(mine.units, units[: int(np.ceil(len(units) * share))])
    enough = len(np.unique(mine.labels[kept])) == 2 and len(np.unique(mine.folds[kept])) > 1
    return kept if enough else np.ones(len(kept), dtype=np.bool_)


def _quality(own: Compared, mine: WordRows, truth: Floats, kernel: Kernel, ridge: float) -> dict[int, float]:
    """How well scores of demonstrations left out foretell their labels: logarithm of likelihood by fold.

    Under -1 stands how much their curve is believed.
    """
    scores, _ = _left_out(own, mine, truth, kernel, ridge)
    units, joined, labels, trust = _by_unit(mine, scores)
    found = calibrate(joined, labels, trust)
    fold = dict(zip(mine.units.tolist(), mine.folds.tolist(), strict=True))
    quality = dict.fromkeys(np.unique(mine.folds).tolist(), 0.0)
    for unit, likely in zip(units.tolist(), found.by_label.tolist(), strict=True):
        quality[fold[unit]] += likely
    return {-1: found.prior} | quality


def _left_out(own: Compared, mine: WordRows, truth: Floats, kernel: Kernel, ridge: float) -> tuple[Floats, Array]:
    """Scores of every row when its demonstration is left out, and the weights of rows when none is.

    ``truth`` is how probably the atom of each row is true.
    """
    yes, no = (max(float(part.sum()), _LEAST_MASS) for part in (mine.weights * truth, mine.weights * (1 - truth)))
    mass = mine.weights * (truth / yes + (1 - truth) / no) * (yes + no) / 2
    matrix = own.gram(kernel).astype(np.float64) + ridge * np.diag(mass.mean() / mass)
    target = 2 * truth - 1
    inverse = _inverse(matrix)
    weights = inverse @ target
    scores = np.zeros(len(target))
    for fold in np.unique(mine.folds):
        out = np.flatnonzero(mine.folds == fold)
        scores[out] = target[out] - np.linalg.solve(inverse[np.ix_(out, out)], weights[out])
    return scores, weights.astype(np.float32)


def _inverse(matrix: Floats) -> Floats:
    """Of a positive definite matrix, in half the time that any other takes."""
    import scipy.linalg  # a quarter of a second, which only teaching needs

    factor, failed = scipy.linalg.lapack.dpotrf(matrix, lower=True)
    if failed:  # rounding: codes have single precision
        inverted: Floats = scipy.linalg.inv(matrix, check_finite=False)
        return inverted
    inverse, _ = scipy.linalg.lapack.dpotri(factor, lower=True, overwrite_c=True)
    found: Floats = np.tril(inverse) + np.tril(inverse, -1).T
    return found


def _by_unit(mine: WordRows, scores: Floats) -> tuple[Ints, Floats, Bools, Floats]:
    """Of every unit its number, one score of its pictures, its label and how far that is trusted."""
    found: dict[int, list[int]] = {}
    for i in np.flatnonzero(mine.originals):
        found.setdefault(int(mine.units[i]), []).append(int(i))
    copies = max(1.0, float(len(mine.rows)) / max(1, int(mine.originals.sum())))
    return (
        np.array(list(found), dtype=np.int64),
        np.array([joint([float(scores[i]) for i in rows]) for rows in found.values()]),
        np.array([bool(mine.labels[rows[0]]) for rows in found.values()]),
        np.array([float(mine.weights[rows[0]]) * copies for rows in found.values()]),
    )
