"""The wooden floor under a scene."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import PIL.Image
import PIL.ImageDraw
from numpy.typing import NDArray

from pix2pred.domains.burger.drawing.canvas import UNITS, tint, vary

_PLANK = 64


@lru_cache(maxsize=16)
def floor(look: int, size: int) -> PIL.Image.Image:
    """Planks, grain and a faint grid of ``size`` cells a side, seeded by ``look``. Callers copy before they draw."""
    side = UNITS * size
    rng = np.random.default_rng(np.random.SeedSequence((look, 0)))
    wood = vary((188, 168, 142), rng, 9)
    image = PIL.Image.new("RGB", (side, side), wood)
    draw = PIL.ImageDraw.Draw(image)
    for top in range(0, side, _PLANK):
        left = -int(rng.integers(0, 300))
        while left < side:
            right = left + int(rng.integers(220, 420))
            draw.rectangle([left, top, right, top + _PLANK], vary(wood, rng, 7), tint(wood, 0.86))
            left = right
    grained = np.asarray(image).astype(np.int16) + _grain(rng, side)[..., None]
    image = PIL.Image.fromarray(np.clip(grained, 0, 255).astype(np.uint8))
    draw = PIL.ImageDraw.Draw(image)
    for edge in range(UNITS, side, UNITS):
        draw.line([edge, 0, edge, side], tint(wood, 0.72), 2)
        draw.line([0, edge, side, edge], tint(wood, 0.72), 2)
    return image


def _grain(rng: np.random.Generator, side: int) -> NDArray[np.int16]:
    """Streaks along the planks in a few whole steps of brightness, which keeps the PNG files small."""
    noise = rng.normal(0, 3.4, (side // 4, side // 40)).astype(np.float32)
    smooth = PIL.Image.fromarray(noise).resize((side, side), PIL.Image.Resampling.BICUBIC)
    return (2 * np.rint(np.asarray(smooth) / 2)).astype(np.int16)
