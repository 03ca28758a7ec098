"""Drawing on a supersampled square: shapes with outlines, and marks that stay inside a shape.

Coordinates are those of a grid cell of 128 units, x to the right and y down, whatever the resolution.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import PIL.Image
import PIL.ImageDraw
from numpy.typing import NDArray

UNITS = 128
"""Side of a cell in drawing units; also its side in pixels at full size."""

SUPERSAMPLING = 3

Color = tuple[int, int, int]
Point = tuple[float, float]


def tint(color: Color, factor: float) -> Color:
    """``color`` made lighter (factor above 1) or darker."""
    r, g, b = (max(0, min(255, round(c * factor))) for c in color)
    return r, g, b


def vary(color: Color, rng: np.random.Generator, amount: float = 10) -> Color:
    """``color`` with a seeded change of brightness and of each channel, at most ``amount`` each."""
    common = rng.uniform(-amount, amount)
    r, g, b = (max(0, min(255, round(c + common + rng.uniform(-amount, amount) / 2))) for c in color)
    return r, g, b


def arc(cx: float, cy: float, rx: float, ry: float, start: float, stop: float) -> list[Point]:
    """Points of an elliptic arc; angles in degrees, 0 to the right, growing clockwise."""
    angles = np.radians(np.linspace(start, stop, 48))
    return [(cx + rx * math.cos(a), cy + ry * math.sin(a)) for a in angles]


def scalloped(cx: float, cy: float, rx: float, ry: float, lobes: int, depth: float, phase: float) -> list[Point]:
    """A closed wavy outline: an ellipse with ``lobes`` bulges of relative ``depth``."""
    points = []
    for a in np.linspace(0, 2 * math.pi, 160, endpoint=False):
        r = 1 - depth + depth * abs(math.sin(lobes * a / 2 + phase))
        points.append((cx + rx * r * math.cos(a), cy + ry * r * math.sin(a)))
    return points


class Canvas:
    """A transparent cell to draw one sprite on."""

    def __init__(self) -> None:
        side = UNITS * SUPERSAMPLING
        self.image = PIL.Image.new("RGBA", (side, side), (0, 0, 0, 0))

    def polygon(self, points: Sequence[Point], color: Color, outline: Color | None = None, width: float = 2.5) -> None:
        """A filled polygon with an optional outline of ``width`` units."""
        scaled = _scale(points)
        draw = PIL.ImageDraw.Draw(self.image)
        draw.polygon(scaled, (*color, 255))
        if outline is not None:
            draw.line([*scaled, *scaled[:2]], (*outline, 255), round(width * SUPERSAMPLING), "curve")

    def ellipse(
        self, center: Point, radii: Point, color: Color, outline: Color | None = None, width: float = 2.5
    ) -> None:
        """A filled ellipse."""
        self.polygon(arc(*center, *radii, 0, 360)[:-1], color, outline, width)

    def rectangle(
        self, left: float, top: float, right: float, bottom: float, color: Color, radius: float = 0,
        outline: Color | None = None, width: float = 2.5,
    ) -> None:  # fmt: skip
        """A filled rectangle with rounded corners."""
        box = [v * SUPERSAMPLING for v in (left, top, right, bottom)]
        PIL.ImageDraw.Draw(self.image).rounded_rectangle(
            box, radius * SUPERSAMPLING, (*color, 255),
            None if outline is None else (*outline, 255), round(width * SUPERSAMPLING),
        )  # fmt: skip

    def line(self, points: Sequence[Point], color: Color, width: float) -> None:
        """A line with round ends."""
        draw = PIL.ImageDraw.Draw(self.image)
        scaled = _scale(points)
        draw.line(scaled, (*color, 255), round(width * SUPERSAMPLING), "curve")
        r = width * SUPERSAMPLING / 2
        for x, y in (scaled[0], scaled[-1]):
            draw.ellipse([x - r, y - r, x + r, y + r], (*color, 255))

    def inside(self, points: Sequence[Point], paint: Callable[[Canvas], None]) -> None:
        """Let ``paint`` draw on a fresh layer and keep what falls inside the polygon ``points``."""
        layer = Canvas()
        paint(layer)
        mask = PIL.Image.new("L", self.image.size, 0)
        PIL.ImageDraw.Draw(mask).polygon(_scale(points), 255)
        empty = PIL.Image.new("RGBA", self.image.size, (0, 0, 0, 0))
        self.image.alpha_composite(PIL.Image.composite(layer.image, empty, mask))

    def shade(self, rng: np.random.Generator, slope: float = 0.16, grain: float = 5) -> None:
        """Light from the upper left, and a soft seeded grain, wherever something is drawn."""
        pixels = np.asarray(self.image)
        side = pixels.shape[0]
        ramp = np.linspace(-1, 1, side, dtype=np.float32)
        light = 1 - slope * (0.7 * ramp[:, None] + 0.3 * ramp[None, :])
        coarse = PIL.Image.fromarray(rng.normal(0, grain, (48, 48)).astype(np.float32))
        noise: NDArray[np.float32] = np.asarray(coarse.resize((side, side), PIL.Image.Resampling.BILINEAR))
        lit = np.clip(pixels[..., :3] * light[..., None] + noise[..., None], 0, 255).astype(np.uint8)
        self.image = PIL.Image.fromarray(np.dstack([lit, pixels[..., 3]]), "RGBA")

    def finished(self, scale: float, quarter_turns: int = 0) -> PIL.Image.Image:
        """The sprite at ``scale`` times a full cell, turned anticlockwise by quarter turns."""
        side = round(UNITS * scale)
        small = self.image.resize((side, side), PIL.Image.Resampling.BOX)
        return small.rotate(90 * quarter_turns)


def _scale(points: Sequence[Point]) -> list[Point]:
    return [(x * SUPERSAMPLING, y * SUPERSAMPLING) for x, y in points]
