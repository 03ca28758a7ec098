"""Principal components of what was seen, and how much they usually leave out of what they were not made from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pix2pred.vlm.distilled.codes import PartCode, RegionCode
from pix2pred.vlm.distilled.sight import Array, split

COMPONENTS: Mapping[str, int] = {"near": 24, "around": 16, "edges": 20, "place": 6}
"""Components of each part."""
USUAL = 0.98
"""The share of regions of demonstrations left out whose strangeness is at most 1."""
_LEAST_SPREAD = 1e-3
"""Components that vary less than this share of the first are noise of drawing and are dropped."""
_FOLDS = 3
"""Components are made again without each third of the demonstrations to see what they leave out of it."""
_LEAST_RESIDUAL = 0.02
"""Of parts that hardly differ at all: a smaller distance is rounding."""
LIGHT = 0.04
"""Whole pictures whose numbers differ by less, in their root mean square, show the same: no more than light differs."""


def region_code(vectors: Array, groups: NDArray[np.int64]) -> RegionCode:
    """The code of a kind of region, from vectors of shape (n, LENGTH) and the demonstration each belongs to."""
    parts = split(vectors.astype(np.float32))
    return RegionCode(
        {name: _part_code(part, groups, COMPONENTS[name], _LEAST_RESIDUAL) for name, part in parts.items()}
    )


def picture_code(vectors: Array, groups: NDArray[np.int64]) -> RegionCode:
    """The code of whole pictures. Each that differs counts once, or what is usual would shrink as episodes repeat."""
    kept: list[int] = []
    shown = np.zeros(vectors.shape, dtype=np.float32)
    lengths = np.zeros(len(vectors), dtype=np.float32)
    for i, vector in enumerate(vectors.astype(np.float32)):
        count = len(kept)
        apart = lengths[:count] + vector @ vector - 2 * (shown[:count] @ vector)
        if not count or apart.min() > LIGHT**2 * vectors.shape[1]:
            shown[count], lengths[count] = vector, vector @ vector
            kept.append(i)
    parts = split(vectors[kept].astype(np.float32))
    return RegionCode({
        name: _part_code(part, groups[kept], COMPONENTS[name], LIGHT * np.sqrt(part.shape[1]))
        for name, part in parts.items()
    })  # fmt: skip


def _part_code(part: Array, groups: NDArray[np.int64], count: int, least: float) -> PartCode:
    mean, components, spread = _components(part, count)
    residual = least
    numbers = np.unique(groups)
    for fold in np.array_split(numbers, min(_FOLDS, len(numbers))):
        out = np.isin(groups, fold)
        if out.all() or len(numbers) < 2:
            continue
        others_mean, others, _ = _components(part[~out], count)
        moved = part[out] - others_mean
        left = np.linalg.norm(moved - moved @ others.T @ others, axis=1)
        residual = max(residual, float(np.quantile(left, USUAL)))
    return PartCode(mean, components, spread, residual)


def _components(part: Array, count: int) -> tuple[Array, Array, Array]:
    """Mean, components and their deviations, rounded as they are stored."""
    import scipy.linalg  # a quarter of a second, which only teaching needs

    mean = part.mean(axis=0)
    centred = (part - mean).astype(np.float64)
    few = len(part) < part.shape[1]  # the products of rows have the same components, and there are fewer of them
    products = (centred @ centred.T if few else centred.T @ centred) / max(1, len(part))
    size = len(products)
    values, vectors = scipy.linalg.eigh(products, subset_by_index=(max(0, size - count), size - 1))
    values, vectors = values[::-1], vectors[:, ::-1].T
    kept = max(1, int((values > max(values[0] * _LEAST_SPREAD**2, 1e-12)).sum()))
    if few:
        vectors = vectors[:kept] @ centred
        vectors /= np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
    signs = np.sign(vectors[np.arange(len(vectors)), np.abs(vectors).argmax(axis=1)])
    components = (vectors * signs[:, None])[:kept].astype(np.float16).astype(np.float32)
    spread = np.sqrt(np.maximum(values[:kept], 1e-8)).astype(np.float32)
    return mean.astype(np.float16).astype(np.float32), components, spread


def spreads_in_kernel(parts: Sequence[PartCode]) -> list[Array]:
    """By what the codes of each part are multiplied so that its variance is 1 in all."""
    return [part.spread / np.sqrt((part.spread**2).sum()) for part in parts]
