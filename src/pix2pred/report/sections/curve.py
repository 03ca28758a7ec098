"""The selection curve: J after each step on a logarithmic scale, with the candidates that lost."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

WIDTH, HEIGHT = 720.0, 240.0
LEFT, RIGHT, TOP, BOTTOM = 64.0, 150.0, 18.0, 40.0


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """A set of predicates at its place in the drawing, in pixels.

    ``text`` says its J, ``label`` what was added; ``bound`` where J is at least that and was not computed to the end.
    """

    x: float
    y: float
    text: str
    label: str
    bound: bool = False


@dataclass(frozen=True, slots=True)
class Curve:
    """The steps taken, the runners-up of each, grid lines as (y, text), and the line's path."""

    steps: tuple[CurvePoint, ...]
    others: tuple[CurvePoint, ...]
    grid: tuple[tuple[float, str], ...]
    path: str
    threshold: float | None
    width: float = WIDTH
    height: float = HEIGHT


def selection_curve(steps: Sequence[Mapping[str, Any]], threshold: float | None) -> Curve:
    """Lay out the steps of ``selection.json``; ``threshold`` is the J at which the climb stops."""
    js = [max(1.0, float(s["J"])) for s in steps]
    others = [max(1.0, float(r["J"])) for s in steps for r in s["runners_up"]]
    low = math.floor(math.log10(min([*js, *others, *([threshold] if threshold else [])])))
    high = math.ceil(math.log10(max([*js, *others]) + 1e-9))
    high = max(high, low + 1)

    def y(j: float) -> float:
        share = (math.log10(max(1.0, j)) - low) / (high - low)
        return round(TOP + (1 - share) * (HEIGHT - TOP - BOTTOM), 1)

    def x(i: int) -> float:
        return round(LEFT + i * (WIDTH - LEFT - RIGHT) / max(1, len(steps) - 1), 1)

    points = [
        CurvePoint(x(i), y(j), f"J {j:,.0f}", s["added"] or ("start, with pinned predicates" if i else "start"))
        for i, (s, j) in enumerate(zip(steps, js, strict=True))
    ]
    dots = [
        CurvePoint(x(i), y(float(r["J"])), j_text(r), str(r["predicate"]), bool(r["lower_bound"]))
        for i, s in enumerate(steps)
        for r in s["runners_up"]
    ]
    grid = tuple((y(10.0**k), f"{10**k:,}") for k in range(low, high + 1))
    path = "M" + " L".join(f"{p.x},{p.y}" for p in points)
    return Curve(tuple(points), tuple(dots), grid, path, y(threshold) if threshold else None)


def j_text(runner: Mapping[str, Any]) -> str:
    """``J``, or "≥ bound" when the search was given up early."""
    return f"{'≥ ' if runner['lower_bound'] else ''}{float(runner['J']):,.0f}"
