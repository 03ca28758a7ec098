"""Samplers of continuous parameters: a Gaussian regressor and a validity classifier, one pair per operator (method 7).

A draw of the Gaussian is kept when it lies in the box and the classifier accepts it; after ``max_rejections`` the last
draw is used, moved into the box. The default estimators are linear and Bayesian, meant for a handful of examples:

- the mean is linear in the features (``BayesianRidge``, one per parameter);
- the spread combines the model's own uncertainty, the residuals, and ``PRIOR_EXAMPLES`` imagined residuals of
  ``PRIOR_SPREAD`` of the box, so that three equal examples give a narrow bell and never a spike;
- validity is logistic in the features, the parameters, and their products, which makes bands possible.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning.samplers_data import Rows, SamplerData, input_row, sampler_data
from pix2pred.structs import Demo, LabelledDemo, Object, Operator
from pix2pred.structs.samplers import Draw, Features, Sampler, clip_to_box

Arrays = Mapping[str, NDArray[np.generic]]

PRIOR_EXAMPLES = 3.0
PRIOR_SPREAD = 0.015
"""Part of the box's side that is the spread of parameters before anything is seen."""

LEAST_SPREAD = 0.005
"""The narrowest spread, as part of the box's side."""

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
    max_rejections: int = 100

    def sample(self, features: Features, objects: Sequence[Object], rng: np.random.Generator) -> Draw:
        """Parameters for an operator bound to ``objects``. Raises ``ValueError`` when one has no features."""
        inputs = input_row(features, objects)
        mean, spread = self.gaussian.at(inputs)
        rejections = 0
        while True:
            params = rng.normal(mean, spread)
            if rejections >= self.max_rejections or self._accepts(inputs, params):
                return Draw(clip_to_box(params, self.low, self.high), self.name, rejections)
            rejections += 1

    def _accepts(self, inputs: Rows, params: Rows) -> bool:
        inside = bool(np.all(params >= self.low) and np.all(params <= self.high))
        return inside and (self.validity is None or self.validity.probability(inputs, params) > 0.5)


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
class QuadraticValidity:
    """Logistic regression on features, parameters, squares of parameters and products of both."""

    centre: Rows
    scale: Rows
    weights: Rows
    bias: Rows

    def probability(self, inputs: Rows, params: Rows) -> float:
        """How likely ``params`` work where the features are ``inputs``."""
        z = _standardised(np.concatenate([inputs, params]), self.centre, self.scale)
        score = float(self.weights @ _products(z[None], len(inputs))[0] + self.bias[0])
        return float(1 / (1 + np.exp(-np.clip(score, -30, 30))))

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """The fields."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}

    @classmethod
    def fit(cls, data: SamplerData) -> Self | None:
        """Fit to positive and negative examples; ``None`` when there are no negatives: then everything is accepted."""
        from sklearn.linear_model import LogisticRegression

        if not len(data.bad_params):
            return None
        x = np.concatenate([np.hstack([data.inputs, data.params]), np.hstack([data.bad_inputs, data.bad_params])])
        y = np.arange(len(x)) < len(data.params)
        centre, scale = x.mean(axis=0), _scales(x)
        rows = _products(_standardised(x, centre, scale), data.inputs.shape[1])
        fitted = LogisticRegression(class_weight="balanced", max_iter=2000, C=3.0).fit(rows, y)
        return cls(centre, scale, np.asarray(fitted.coef_[0]), np.asarray(fitted.intercept_))


def _scales(x: Rows) -> Rows:
    """Standard deviations; infinite where a column does not vary, so that nothing is concluded from it."""
    spread = x.std(axis=0)
    return np.where(spread > 1e-6, spread, np.inf)


def _standardised(x: Rows, centre: Rows, scale: Rows) -> Rows:
    return np.clip((x - centre) / scale, -_FARTHEST, _FARTHEST)


def _products(z: Rows, inputs: int) -> Rows:
    """Columns, squares of the parameters, and products of every parameter with everything before it."""
    columns = [z]
    for i in range(inputs, z.shape[1]):
        columns.append(z[:, [i]] * z[:, : i + 1])
    return np.hstack(columns)


class SamplerFitter(Protocol):
    """Makes a sampler of examples of which at least one is positive."""

    def __call__(self, data: SamplerData, low: Sequence[float], high: Sequence[float]) -> Sampler:
        """The sampler; parameters lie between ``low`` and ``high``."""
        ...


def fit_gaussian(data: SamplerData, low: Sequence[float], high: Sequence[float]) -> LearnedSampler:
    """The default estimators."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # BayesianRidge divides by residuals that can be zero
        gaussian = LinearGaussian.fit(data, low, high)
    return LearnedSampler("gaussian", gaussian, QuadraticValidity.fit(data), tuple(low), tuple(high))


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
