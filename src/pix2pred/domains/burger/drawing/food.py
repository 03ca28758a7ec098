"""How food looks: slight side view, every item with its own seeded hue, size and texture.

All items stand on the line y = 116 of their cell, so that a stack shows a strip of the lower side of every member.
"""

from __future__ import annotations

import math

import numpy as np

from pix2pred.domains.burger.drawing.canvas import Canvas, Color, Point, arc, scalloped, tint, vary

MIDDLE = 64.0
BASE = 116.0

GOLDEN: Color = (219, 146, 62)
CREAM: Color = (252, 226, 170)


def _half_width(rng: np.random.Generator) -> float:
    return float(rng.uniform(40, 44))


def bottom_bun(canvas: Canvas, rng: np.random.Generator, prepared: bool) -> None:
    """The lower half of a bun: a bowl of crust under a pale cut face."""
    width, crust = _half_width(rng), vary(GOLDEN, rng)
    face_y, depth = BASE - 27, 13.0
    body = _bulging(width, face_y, 27)
    canvas.polygon(body, crust, tint(crust, 0.5))
    canvas.inside(body, lambda c: c.line(arc(MIDDLE, face_y, width, 17, 15, 165), tint(crust, 1.16), 5))
    canvas.ellipse((MIDDLE, face_y), (width, depth), vary(CREAM, rng, 6), tint(crust, 0.6))

    def crumbs(layer: Canvas) -> None:
        for x, y in _scatter(rng, 26, width * 0.85, depth * 0.75):
            layer.ellipse((MIDDLE + x, face_y + y), (1.8, 1.0), tint(CREAM, 0.86))

    canvas.inside(arc(MIDDLE, face_y, width, depth, 0, 360), crumbs)
    canvas.shade(rng)


def _bulging(width: float, top: float, height: float) -> list[Point]:
    """The lower half of a rounded box: fuller at the sides than an ellipse."""
    points = []
    for a in np.linspace(0, math.pi, 48):
        x, y = math.cos(a), math.sin(a)
        points.append((MIDDLE + width * math.copysign(abs(x) ** 0.55, x), top + height * y**0.75))
    return points


def top_bun(canvas: Canvas, rng: np.random.Generator, prepared: bool) -> None:
    """The upper half of a bun: a glossy dome with sesame seeds."""
    width, crust = _half_width(rng), vary(GOLDEN, rng)
    rim, height = BASE - 13, float(rng.uniform(40, 45))
    dome = [*arc(MIDDLE, rim, width, height, 180, 360), *arc(MIDDLE, rim, width, 12, 0, 180)]
    canvas.polygon(dome, crust, tint(crust, 0.5))

    def crust_marks(layer: Canvas) -> None:
        layer.line(arc(MIDDLE, rim - 3, width - 2, 13, 12, 168), tint(crust, 1.28), 5)
        layer.ellipse((MIDDLE - 15, rim - height * 0.66), (15, 7), tint(crust, 1.18))
        for x, y in _spread(rng, 17, width * 0.8, height * 0.74):
            _seed(layer, (MIDDLE + x, rim - 8 - y), rng)

    canvas.inside(dome, crust_marks)
    canvas.shade(rng)


def _seed(canvas: Canvas, at: Point, rng: np.random.Generator) -> None:
    angle = rng.uniform(0, math.pi)
    dx, dy = 2.1 * math.cos(angle), 1.5 * math.sin(angle)
    ends = [(at[0] - dx, at[1] - dy), (at[0] + dx, at[1] + dy)]
    canvas.line([(x + 0.8, y + 1.0) for x, y in ends], (146, 92, 36), 4.4)
    canvas.line(ends, (255, 243, 206), 3.8)


def patty(canvas: Canvas, rng: np.random.Generator, prepared: bool) -> None:
    """A thick disc of mince: pink and mottled when raw, dark brown with grill lines when cooked."""
    width = _half_width(rng) - 1
    raw, brown = vary((236, 122, 128), rng), vary((108, 62, 34), rng, 7)
    meat = brown if prepared else raw
    top_y, depth, wall = BASE - 31, 15.0, 17.0
    phase = float(rng.uniform(0, 6))
    face = scalloped(MIDDLE, top_y, width, depth, 26, 0.05, phase)
    wobble = [(x, y + float(rng.normal(0, 0.7))) for x, y in arc(MIDDLE, top_y + wall, width, depth, 0, 180)]
    side = [*arc(MIDDLE, top_y, width, depth, 180, 360), *wobble]
    canvas.polygon(side, tint(meat, 0.84), tint(meat, 0.5))

    def side_marks(layer: Canvas) -> None:
        for x, y in _scatter(rng, 70, width, 24):
            tone = rng.choice([0.62, 1.02]) if prepared else rng.choice([0.7, 1.25])
            layer.ellipse(
                (MIDDLE + x, top_y + wall / 2 + 6 + y), tuple(rng.uniform(1.2, 2.8, 2)), tint(meat, float(tone))
            )
        if prepared:
            for x in np.linspace(-0.8, 0.8, 6) * width:
                drop = math.sqrt(1 - (x / width) ** 2) * depth
                layer.line([(MIDDLE + x, top_y + drop), (MIDDLE + x, top_y + drop + wall)], (40, 22, 14), 3.4)
            layer.line(arc(MIDDLE, top_y + 1, width, depth, 5, 175), tint(meat, 1.75), 3.4)

    canvas.inside(side, side_marks)
    canvas.polygon(face, meat, tint(meat, 0.62), 1.5)
    canvas.inside(face, lambda layer: _face_marks(layer, rng, meat, (width, depth, top_y), prepared))
    canvas.shade(rng)


def _face_marks(
    layer: Canvas, rng: np.random.Generator, meat: Color, size: tuple[float, float, float], prepared: bool
) -> None:
    width, depth, top_y = size
    for x, y in _scatter(rng, 80, width, depth):
        tone = float(rng.choice([0.8, 1.2]) if prepared else rng.choice([0.76, 1.0, 1.3]))
        layer.ellipse((MIDDLE + x, top_y + y), tuple(rng.uniform(1.0, 3.0, 2) * (1, 0.6)), tint(meat, tone))
    if prepared:
        for x in np.linspace(-1.1, 0.7, 6) * width:
            layer.line([(MIDDLE + x, top_y + depth), (MIDDLE + x + 17, top_y - depth)], (34, 19, 12), 4)
    else:
        for x, y in _scatter(rng, 9, width * 0.8, depth * 0.8):
            layer.ellipse((MIDDLE + x, top_y + y), (3.4, 1.6), (252, 214, 208))


def lettuce(canvas: Canvas, rng: np.random.Generator, prepared: bool) -> None:
    """A round leafy head when whole, a loose heap of shreds when chopped."""
    if prepared:
        _shreds(canvas, rng)
    else:
        _head(canvas, rng)
    canvas.shade(rng, 0.12)


def _head(canvas: Canvas, rng: np.random.Generator) -> None:
    green = vary((96, 172, 66), rng)
    width, height = float(rng.uniform(44, 47)), float(rng.uniform(34, 37))
    y = BASE - height
    outline = tint(green, 0.45)
    layers = [(1.0, 0.74, 11, 0.0), (0.84, 0.95, 9, 2.0), (0.62, 1.2, 8, 3.0), (0.36, 1.4, 7, 3.5)]
    for size, tone, lobes, lift in layers:
        leaf = scalloped(MIDDLE, y + lift, width * size, height * size, lobes, 0.13, float(rng.uniform(0, 6)))
        canvas.polygon(leaf, tint(green, tone), outline, 2.2 if size == 1 else 1.6)
    for angle in np.linspace(0, 2 * math.pi, 9, endpoint=False) + rng.uniform(0, 0.6):
        inner, outer = 0.2, 0.86
        ends = [(MIDDLE + width * r * math.cos(angle), y + 2 + height * r * math.sin(angle)) for r in (inner, outer)]
        canvas.line(ends, tint(green, 1.5), 2.0)


def _shreds(canvas: Canvas, rng: np.random.Generator) -> None:
    green = vary((112, 186, 74), rng)
    y = BASE - 21
    for index, (x, dy) in enumerate(_spread(rng, 34, 45, 17, centred=True)):
        angle = float(rng.uniform(-0.9, 0.9)) + (math.pi / 2 if index % 4 == 0 else 0)
        half = float(rng.uniform(6, 10))
        cx, cy = MIDDLE + x * 0.88, y + dy
        bend = float(rng.uniform(-4, 4))
        dx, ddy = half * math.cos(angle), half * math.sin(angle) * 0.55
        curve = [(cx - dx, cy - ddy), (cx - bend * 0.3, cy + bend), (cx + dx, cy + ddy)]
        color = tint(green, float(rng.choice([0.72, 0.95, 1.2, 1.4])))
        canvas.line(curve, tint(green, 0.42), 6.4)
        canvas.line(curve, color, 4.2)


def cheese(canvas: Canvas, rng: np.random.Generator, prepared: bool) -> None:
    """A wedge with holes."""
    yellow = vary((250, 204, 52), rng, 7)
    edge = tint(yellow, 0.52)
    tip, left, right = (18.0, 92.0), (74.0, 62.0), (110.0, 84.0)
    drop = 26.0

    def below(p: Point) -> Point:
        return p[0], p[1] + drop

    canvas.polygon([tip, left, right], tint(yellow, 1.16), edge)
    side = [tip, right, below(right), (tip[0], tip[1] + drop - 3)]
    canvas.polygon(side, yellow, edge)

    def holes(layer: Canvas) -> None:
        for x, y, r in ((38, 104, 5.5), (60, 99, 4.0), (84, 102, 7.0), (101, 95, 3.5), (70, 110, 3.4)):
            dx, dy = rng.uniform(-3, 3, 2)
            layer.ellipse((x + dx, y + dy), (r, r), tint(yellow, 0.7), edge, 1.2)

    canvas.inside(side, holes)
    canvas.ellipse((70, 76), (6, 3.2), tint(yellow, 0.8), edge, 1.2)
    canvas.shade(rng, 0.1)


def _scatter(rng: np.random.Generator, count: int, rx: float, ry: float) -> list[Point]:
    angle, radius = rng.uniform(0, 2 * math.pi, count), np.sqrt(rng.uniform(0, 1, count))
    return [(float(rx * r * math.cos(a)), float(ry * r * math.sin(a))) for a, r in zip(angle, radius, strict=True)]


def _spread(rng: np.random.Generator, count: int, rx: float, ry: float, *, centred: bool = False) -> list[Point]:
    """Evenly spread points of a half (or, ``centred``, a whole) ellipse: best of a few random tries each."""
    chosen: list[Point] = []
    for _ in range(count):
        tries = [(x, y if centred else abs(y)) for x, y in _scatter(rng, 8, rx, ry)]
        chosen.append(max(tries, key=lambda p: min((math.dist(p, q) for q in chosen), default=0)))
    return chosen
