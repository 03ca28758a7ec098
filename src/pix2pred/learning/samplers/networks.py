"""The paper's sampler networks (method 7), trained with PyTorch and evaluated with numpy.

Two networks with hidden layers of 32 and 32 units: one gives mean and diagonal variance (ELU + 1, Gaussian likelihood),
the other whether parameters work (cross-entropy, negatives subsampled to the number of positives).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning.samplers.data import Rows, SamplerData
from pix2pred.learning.samplers.learn import LearnedSampler
from pix2pred.system.extras import optional

REGRESSION_STEPS = 1000
CLASSIFICATION_STEPS = 10_000
PATIENCE = 5000
LEARNING_RATE = 1e-3
HIDDEN = 32
SEED = 0

_LAYERS = ("w1", "b1", "w2", "b2", "w3", "b3")


@dataclass(frozen=True)
class Network:
    """Three layers with ReLU between them."""

    layers: tuple[Rows, ...]

    def __call__(self, x: Rows) -> Rows:
        """The outputs for one row of inputs."""
        w1, b1, w2, b2, w3, b3 = self.layers
        hidden = np.maximum(w2 @ np.maximum(w1 @ x + b1, 0) + b2, 0)
        return np.asarray(w3 @ hidden + b3)

    def arrays(self) -> dict[str, Rows]:
        """The weights by name."""
        return dict(zip(_LAYERS, self.layers, strict=True))

    @classmethod
    def of(cls, arrays: Mapping[str, Rows]) -> Self:
        """The network whose ``arrays()`` these are."""
        return cls(tuple(arrays[name] for name in _LAYERS))


@dataclass(frozen=True)
class NetworkGaussian:
    """Mean and spread from a network, between a normalisation of its inputs and outputs."""

    network: Network
    shift: Rows
    range: Rows
    out_shift: Rows
    out_range: Rows

    def at(self, inputs: Rows) -> tuple[Rows, Rows]:
        """Mean and standard deviation per parameter."""
        mean, raw = np.split(self.network((inputs - self.shift) / self.range), 2)
        variance = np.where(raw > 0, raw, np.expm1(np.minimum(raw, 0))) + 1
        return mean * self.out_range + self.out_shift, np.sqrt(np.maximum(variance, 1e-12)) * self.out_range

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """Weights and normalisation."""
        return self.network.arrays() | {
            "shift": self.shift, "range": self.range, "out_shift": self.out_shift, "out_range": self.out_range
        }  # fmt: skip

    @classmethod
    def of(cls, arrays: Mapping[str, Rows]) -> Self:
        """The estimator whose ``arrays()`` these are."""
        return cls(Network.of(arrays), *(arrays[n] for n in ("shift", "range", "out_shift", "out_range")))


@dataclass(frozen=True)
class NetworkValidity:
    """How likely parameters work, from a network."""

    network: Network
    shift: Rows
    range: Rows

    def probability(self, inputs: Rows, params: Rows) -> float:
        """Between 0 and 1."""
        score = self.network((np.concatenate([inputs, params]) - self.shift) / self.range).item()
        return float(1 / (1 + np.exp(-np.clip(score, -30, 30))))

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """Weights and normalisation."""
        return self.network.arrays() | {"shift": self.shift, "range": self.range}

    @classmethod
    def of(cls, arrays: Mapping[str, Rows]) -> Self:
        """The estimator whose ``arrays()`` these are."""
        return cls(Network.of(arrays), arrays["shift"], arrays["range"])


def fit_networks(data: SamplerData, low: Sequence[float], high: Sequence[float]) -> LearnedSampler:
    """The paper's sampler. Raises ``MissingExtraError`` without PyTorch (extra ``torch``)."""
    return LearnedSampler("torch", _fit_gaussian(data), _fit_validity(data), tuple(low), tuple(high))


def _normalisation(x: Rows) -> tuple[Rows, Rows]:
    """Minimum and range; ranges below 1 are not stretched."""
    return x.min(axis=0), np.maximum(np.ptp(x, axis=0), 1.0)


def _fit_gaussian(data: SamplerData) -> NetworkGaussian:
    torch = optional("torch", "torch")
    (shift, span), (out_shift, out_span) = _normalisation(data.inputs), _normalisation(data.params)
    x, y = _tensor((data.inputs - shift) / span), _tensor((data.params - out_shift) / out_span)

    def loss(output: Any) -> Any:
        mean, raw = output.chunk(2, dim=1)
        return torch.nn.functional.gaussian_nll_loss(mean, y, torch.nn.functional.elu(raw) + 1)

    network = _train(x, 2 * y.shape[1], loss, REGRESSION_STEPS, REGRESSION_STEPS)
    return NetworkGaussian(network, shift, span, out_shift, out_span)


def _fit_validity(data: SamplerData) -> NetworkValidity | None:
    torch = optional("torch", "torch")
    if not len(data.bad_params):
        return None
    good = np.hstack([data.inputs, data.params])
    bad = np.hstack([data.bad_inputs, data.bad_params])
    if len(bad) > len(good):
        bad = bad[np.random.default_rng(SEED).permutation(len(bad))[: len(good)]]
    rows = np.concatenate([good, bad])
    shift, span = _normalisation(rows)
    x, y = _tensor((rows - shift) / span), _tensor((np.arange(len(rows)) < len(good)).astype(float)[:, None])
    loss = torch.nn.BCEWithLogitsLoss()
    network = _train(x, 1, lambda output: loss(output, y), CLASSIFICATION_STEPS, PATIENCE)
    return NetworkValidity(network, shift, span)


def _tensor(values: Rows) -> Any:
    return optional("torch", "torch").tensor(values, dtype=optional("torch", "torch").float64)


def _train(x: Any, outputs: int, loss: Any, steps: int, patience: int) -> Network:
    """Full-batch Adam; keeps the weights of the lowest loss and stops after ``patience`` steps without a lower one."""
    torch = optional("torch", "torch")
    generator = torch.Generator().manual_seed(SEED)
    sizes = [x.shape[1], HIDDEN, HIDDEN, outputs]
    layers = [torch.nn.Linear(a, b, dtype=torch.float64) for a, b in pairwise(sizes)]
    for layer in layers:
        for weights in (layer.weight, layer.bias):
            torch.nn.init.uniform_(weights, -(layer.in_features**-0.5), layer.in_features**-0.5, generator=generator)
    network = torch.nn.Sequential(layers[0], torch.nn.ReLU(), layers[1], torch.nn.ReLU(), layers[2])
    optimiser = torch.optim.Adam(network.parameters(), lr=LEARNING_RATE)
    best, best_weights, since = float("inf"), _weights(layers), 0
    for _ in range(steps):
        optimiser.zero_grad()
        value = loss(network(x))
        if value.item() < best:
            best, best_weights, since = value.item(), _weights(layers), 0
        elif (since := since + 1) > patience:
            break
        value.backward()
        optimiser.step()
    return Network(best_weights)


def _weights(layers: Sequence[Any]) -> tuple[Rows, ...]:
    return tuple(np.array(w.detach().numpy()) for layer in layers for w in (layer.weight, layer.bias))
