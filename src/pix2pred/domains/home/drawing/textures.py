"""Surfaces drawn by our own code: planks, tiles, carpet, plaster, stone, cloth. Seeded, 256 pixels square."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

Texture = NDArray[np.uint8]
Rng = np.random.Generator

SIDE = 256


def smooth_noise(rng: Rng, cells: int, octaves: int = 3) -> NDArray[np.float64]:
    """Values around 0 that vary over ``cells`` cells and finer, and fit together at the borders."""
    total = np.zeros((SIDE, SIDE))
    for octave in range(octaves):
        n = cells * 2**octave
        grid = rng.normal(size=(n, n))
        steps = np.arange(SIDE) * n / SIDE
        low = steps.astype(int) % n
        part = steps - steps.astype(int)
        part = part * part * (3 - 2 * part)
        high = (low + 1) % n
        rows = grid[low] * (1 - part)[:, None] + grid[high] * part[:, None]
        total += (rows[:, low] * (1 - part) + rows[:, high] * part) / 2**octave
    return total


def _coloured(base: NDArray[np.float64], light: NDArray[np.float64]) -> Texture:
    return np.clip((base * (1 + light)[..., None]) * 255, 0, 255).astype(np.uint8)


def planks(base: NDArray[np.float64], rng: Rng) -> Texture:
    """Wooden boards with grain."""
    rows = int(rng.integers(4, 8))
    y = np.arange(SIDE) * rows // SIDE
    tone = rng.normal(0, 0.07, rows)[y][:, None]
    stretched = np.repeat(smooth_noise(rng, 4, 4)[:, ::8], 8, axis=1)[:, :SIDE]
    gap = ((np.arange(SIDE) * rows) % SIDE < rows * 2)[:, None] * -0.35
    return _coloured(base, tone + 0.06 * stretched + 0.02 * rng.normal(size=(SIDE, SIDE)) + gap)


def tiles(base: NDArray[np.float64], rng: Rng) -> Texture:
    """Square tiles with joints."""
    n = int(rng.integers(3, 6))
    i = np.arange(SIDE) * n // SIDE
    tone = rng.normal(0, 0.03, (n, n))[i][:, i]
    near = (np.arange(SIDE) * n) % SIDE < n * 3
    joint = (near[:, None] | near[None, :]) * -0.25
    return _coloured(base, tone + joint + 0.02 * smooth_noise(rng, 8, 2))


def carpet(base: NDArray[np.float64], rng: Rng) -> Texture:
    """Short pile."""
    return _coloured(base, 0.1 * rng.normal(size=(SIDE, SIDE)) + 0.04 * smooth_noise(rng, 5, 2))


def plaster(base: NDArray[np.float64], rng: Rng) -> Texture:
    """A painted wall."""
    return _coloured(base, 0.025 * smooth_noise(rng, 6, 4))


def stone(base: NDArray[np.float64], rng: Rng) -> Texture:
    """Polished stone with veins."""
    veins = np.exp(-(smooth_noise(rng, 3, 4) ** 2) * 40)
    return _coloured(base, 0.06 * smooth_noise(rng, 10, 2) - 0.12 * veins)


def stripes(base: NDArray[np.float64], rng: Rng) -> Texture:
    """Wallpaper."""
    n = int(rng.integers(6, 14))
    band = ((np.arange(SIDE) * n // SIDE) % 2)[None, :] * float(rng.uniform(-0.16, -0.06))
    return _coloured(base, band + 0.02 * smooth_noise(rng, 6, 3))


def bricks(base: NDArray[np.float64], rng: Rng) -> Texture:
    """A brick wall."""
    n = 10
    row = np.arange(SIDE) * n // SIDE
    x = (np.arange(SIDE)[None, :] + (row % 2)[:, None] * SIDE // n) % SIDE
    column = x * n // (2 * SIDE)
    tone = rng.normal(0, 0.1, (n, n))[row[:, None], column]
    joint = ((np.arange(SIDE) * n) % SIDE < 2 * n)[:, None] | ((x * n) % (2 * SIDE) < 2 * n)
    return _coloured(base, np.where(joint, 0.35, tone) + 0.03 * smooth_noise(rng, 16, 2))


SURFACES: Mapping[str, Callable[[NDArray[np.float64], Rng], Texture]] = {
    "planks": planks, "tiles": tiles, "carpet": carpet, "plaster": plaster, "stone": stone, "stripes": stripes,
    "bricks": bricks,
}  # fmt: skip
