"""Samplers of continuous parameters: a Gaussian regressor and a validity classifier, one pair per operator (method 7).

A draw of the Gaussian is accepted when it lies in the box and the classifier finds it more likely than not to work.
With ``choices`` above 1 the likeliest of that many accepted draws is used; after ``max_rejections`` the likeliest draw,
accepted or not, moved into the box. The default estimators are Bayesian, meant for a handful of examples:

- the mean is linear in the features (``BayesianRidge``, one per parameter);
- the spread combines the model's own uncertainty, the residuals, and ``PRIOR_EXAMPLES`` imagined residuals of
  ``PRIOR_SPREAD`` of the box, so that three equal examples give a narrow bell and never a spike;
- validity is a Gaussian process over features and parameters that finds out which of them matter.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning.samplers.data import Rows, SamplerData, input_row, sampler_data
from pix2pred.structs import Demo, LabelledDemo, Object, Operator
from pix2pred.structs.samplers import Draw, Features, Sampler, clip_to_box

PRIOR_EXAMPLES = 3.0
PRIOR_SPREAD = 0.015
"""Part of the box's side that is the spread of parameters before anything is seen."""

LEAST_SPREAD = 0.005
"""The narrowest spread, as part of the box's side."""

CHOICES = 10
"""Accepted draws of which the default sampler uses the likeliest. Where half of what is tried works, so would half of
all draws that are merely more likely than not."""

LEAST_EXAMPLES = 5
"""Positive and negative examples without which, each, there is no classifier: anything tells two points from one."""

MOST_EXAMPLES = 150
"""Positive and negative examples that the classifier is fitted to, each; fitting grows with the third power."""

_FARTHEST = 3.0
"""Standardised features are moved to at most this: outside of what was seen a sampler stays near what it knows."""


class Gaussian(Protocol):
    """A normal distribution of parameters, given features."""

    def at(self, inputs: Rows) -> tuple[Rows, Rows]:
        """Mean and standard deviation per parameter."""
        ...

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """Everything it is, as plain arrays."""
        ...


class Validity(Protocol):
    """How likely parameters work."""

    def probability(self, inputs: Rows, params: Rows) -> float:
        """Between 0 and 1."""
        ...

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """Everything it is, as plain arrays."""
        ...


@dataclass(frozen=True)
class LearnedSampler:
    """Draws from ``gaussian`` until ``validity`` accepts. ``name`` says which estimators they are."""

    name: str
    gaussian: Gaussian
    validity: Validity | None
    low: tuple[float, ...]
    high: tuple[float, ...]
    choices: int = 1
    max_rejections: int = 100

    def sample(self, features: Features, objects: Sequence[Object], rng: np.random.Generator) -> Draw:
        """Parameters for an operator bound to ``objects``. Raises ``ValueError`` when one has no features."""
        inputs = input_row(features, objects)
        mean, spread = self.gaussian.at(inputs)
        wanted = self.choices if self.validity else 1
        best, likeliest = mean, -1.0
        accepted = rejections = 0
        while accepted < wanted and rejections < self.max_rejections:
            params = rng.normal(mean, spread)
            probability = self._probability(inputs, params)
            if probability > likeliest:
                best, likeliest = params, probability
            if probability > 0.5:
                accepted += 1
            else:
                rejections += 1
        return Draw(clip_to_box(best, self.low, self.high), self.name, rejections)

    def _probability(self, inputs: Rows, params: Rows) -> float:
        """How likely parameters work; 0 outside of the box."""
        if not (np.all(params >= self.low) and np.all(params <= self.high)):
            return 0.0
        return self.validity.probability(inputs, params) if self.validity else 1.0


@dataclass(frozen=True)
class LinearGaussian:
    """Mean ``intercept + coefficients @ z`` of the standardised features ``z``, and how sure that is."""

    centre: Rows
    scale: Rows
    coefficients: Rows
    intercept: Rows
    covariance: Rows
    noise: Rows
    least: Rows

    def at(self, inputs: Rows) -> tuple[Rows, Rows]:
        """Mean and standard deviation per parameter."""
        z = _standardised(inputs, self.centre, self.scale)
        mean = self.intercept + self.coefficients @ z
        variance = self.noise**2 + np.einsum("i,dij,j->d", z, self.covariance, z)
        return mean, np.maximum(np.sqrt(variance), self.least)

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """The fields."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}

    @classmethod
    def fit(cls, data: SamplerData, low: Sequence[float], high: Sequence[float]) -> Self:
        """Fit to the positive examples."""
        from sklearn.linear_model import BayesianRidge

        x, y = data.inputs, data.params
        count, d = y.shape
        side = np.asarray(high, dtype=float) - np.asarray(low, dtype=float)
        centre, scale = x.mean(axis=0), _scales(x)
        z = _standardised(x, centre, scale)
        coefficients, covariance = np.zeros((d, x.shape[1])), np.zeros((d, x.shape[1], x.shape[1]))
        intercept, noise = y.mean(axis=0), np.zeros(d)
        for i in range(d):
            if np.ptp(y[:, i]) > 1e-9 * side[i] and count > 2:
                ridge = BayesianRidge().fit(z, y[:, i] / side[i])
                coefficients[i], intercept[i] = ridge.coef_ * side[i], ridge.intercept_ * side[i]
                covariance[i] = ridge.sigma_ * side[i] ** 2
            residuals = y[:, i] - intercept[i] - z @ coefficients[i]
            imagined = PRIOR_EXAMPLES * (PRIOR_SPREAD * side[i]) ** 2
            noise[i] = np.sqrt((imagined + np.sum(residuals**2)) / (PRIOR_EXAMPLES + count))
        return cls(centre, scale, coefficients, intercept, covariance, noise, LEAST_SPREAD * side)


@dataclass(frozen=True)
class KernelValidity:
    """Gaussian process classification of features and parameters (Rasmussen and Williams 2006, algorithms 3.1 and 3.2).

    Every column has a length of its own, fitted to the evidence, so that columns that do not matter are left out, and
    any number of bands is possible. Far from everything seen the answer is one half.
    """

    centre: Rows
    scale: Rows
    lengths: Rows
    examples: Rows
    weights: Rows

    def probability(self, inputs: Rows, params: Rows) -> float:
        """How likely ``params`` work where the features are ``inputs``."""
        z = _standardised(np.concatenate([inputs, params]), self.centre, self.scale)
        distances = (((z - self.examples) / self.lengths) ** 2).sum(axis=1)
        score = float(np.exp(-0.5 * distances) @ self.weights)
        return float(1 / (1 + np.exp(-np.clip(score, -30, 30))))

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """The fields."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}

    @classmethod
    def fit(cls, data: SamplerData) -> Self | None:
        """Fit to positive and negative examples; ``None`` when there are too few: then everything is accepted."""
        from sklearn.gaussian_process import GaussianProcessClassifier
        from sklearn.gaussian_process.kernels import RBF, ConstantKernel

        if min(len(data.params), len(data.bad_params)) < LEAST_EXAMPLES:
            return None
        good = _spread_out(np.hstack([data.inputs, data.params]))
        bad = _spread_out(np.hstack([data.bad_inputs, data.bad_params]))
        x = np.concatenate([good, bad])
        centre, scale = x.mean(axis=0), _scales(x)
        examples, varies = _standardised(x, centre, scale), np.isfinite(scale)
        lengths = np.ones(len(scale))
        if not varies.any():  # the same parameters worked and failed
            return cls(centre, scale, lengths, examples[:1], np.log([len(good) / len(bad)]))
        kernel = ConstantKernel(4.0, (1.0, 100.0)) * RBF(np.full(varies.sum(), 2.0), (0.3, 100.0))
        process = GaussianProcessClassifier(kernel, random_state=0).fit(
            examples[:, varies], np.arange(len(x)) < len(good)
        )
        fitted = process.base_estimator_
        lengths[varies] = fitted.kernel_.k2.length_scale
        weights = fitted.kernel_.k1.constant_value * (fitted.y_train_ - fitted.pi_)
        return cls(centre, scale, lengths, examples, weights)


def _spread_out(rows: Rows) -> Rows:
    """At most ``MOST_EXAMPLES`` rows, evenly from first to last."""
    if len(rows) <= MOST_EXAMPLES:
        return rows
    return np.asarray(rows[np.linspace(0, len(rows) - 1, MOST_EXAMPLES).round().astype(int)])


def _scales(x: Rows) -> Rows:
    """Standard deviations; infinite where a column does not vary, so that nothing is concluded from it."""
    spread = x.std(axis=0)
    return np.where(spread > 1e-6, spread, np.inf)


def _standardised(x: Rows, centre: Rows, scale: Rows) -> Rows:
    return np.clip((x - centre) / scale, -_FARTHEST, _FARTHEST)


class SamplerFitter(Protocol):
    """Makes a sampler of examples of which at least one is positive."""

    def __call__(self, data: SamplerData, low: Sequence[float], high: Sequence[float]) -> Sampler:
        """The sampler; parameters lie between ``low`` and ``high``."""
        ...


def fit_gaussian(data: SamplerData, low: Sequence[float], high: Sequence[float]) -> LearnedSampler:
    """The default estimators."""
    from sklearn.exceptions import ConvergenceWarning

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # BayesianRidge divides by residuals that can be zero
        warnings.simplefilter("ignore", ConvergenceWarning)  # a length at its bound: the column does not matter
        gaussian = LinearGaussian.fit(data, low, high)
        validity = KernelValidity.fit(data)
    return LearnedSampler("gaussian", gaussian, validity, tuple(low), tuple(high), CHOICES)


def learn_samplers(
    operators: Sequence[Operator],
    demos: Sequence[Demo],
    labelled: Sequence[LabelledDemo],
    fit: SamplerFitter = fit_gaussian,
) -> dict[str, Sampler]:
    """A sampler for every operator whose skill has continuous parameters, by the operator's name.

    ``labelled`` holds the labels of ``demos``, demonstration by demonstration. An operator of objects without features
    (photos) gets none; its parameters are then drawn uniformly.
    """
    predicates = {a.predicate for op in operators for a in (*op.preconditions, *op.add, *op.delete)}
    restricted = [demo.restricted(predicates) for demo in labelled]
    samplers: dict[str, Sampler] = {}
    for op in operators:
        if op.skill.dimension and all(state.features for demo in demos for state in demo.states):
            data = sampler_data(op, demos, restricted)
            if len(data.params):
                samplers[op.name] = fit(data, op.skill.low, op.skill.high)
    return samplers
