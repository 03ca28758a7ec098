"""The wooden floor under a scene."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import PIL.Image
import PIL.ImageDraw
from numpy.typing import NDArray

from pix2pred.domains.burger.drawing.canvas import UNITS, tint, vary
from pix2pred.domains.burger.world import SIZE

SIDE = UNITS * SIZE
"""Side of a picture in pixels."""

_PLANK = 64


@lru_cache(maxsize=16)
def floor(look: int) -> PIL.Image.Image:
    """Planks, grain and a faint grid, seeded by ``look``. Callers copy before they draw on it."""
    rng = np.random.default_rng(np.random.SeedSequence((look, 0)))
    wood = vary((188, 168, 142), rng, 9)
    image = PIL.Image.new("RGB", (SIDE, SIDE), wood)
    draw = PIL.ImageDraw.Draw(image)
    for top in range(0, SIDE, _PLANK):
        left = -int(rng.integers(0, 300))
        while left < SIDE:
            right = left + int(rng.integers(220, 420))
            draw.rectangle([left, top, right, top + _PLANK], vary(wood, rng, 7), tint(wood, 0.86))
            left = right
    grained = np.asarray(image).astype(np.int16) + _grain(rng)[..., None]
    image = PIL.Image.fromarray(np.clip(grained, 0, 255).astype(np.uint8))
    draw = PIL.ImageDraw.Draw(image)
    for edge in range(UNITS, SIDE, UNITS):
        draw.line([edge, 0, edge, SIDE], tint(wood, 0.72), 2)
        draw.line([0, edge, SIDE, edge], tint(wood, 0.72), 2)
    return image


def _grain(rng: np.random.Generator) -> NDArray[np.int16]:
    """Streaks along the planks in a few whole steps of brightness, which keeps the PNG files small."""
    noise = rng.normal(0, 3.4, (SIDE // 4, SIDE // 40)).astype(np.float32)
    smooth = PIL.Image.fromarray(noise).resize((SIDE, SIDE), PIL.Image.Resampling.BICUBIC)
    return (2 * np.rint(np.asarray(smooth) / 2)).astype(np.int16)
