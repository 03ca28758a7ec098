"""How stations and the robot look."""

from __future__ import annotations

import numpy as np

from pix2pred.domains.burger.drawing.canvas import Canvas, Color, arc, tint, vary

OUTLINE: Color = (34, 34, 40)


def grill(canvas: Canvas, rng: np.random.Generator, prepared: bool) -> None:
    """A dark metal box with glowing bars and knobs at the front."""
    metal = vary((70, 74, 84), rng, 8)
    canvas.rectangle(5, 12, 123, 125, metal, 12, OUTLINE, 3)
    canvas.rectangle(12, 18, 116, 102, (46, 16, 12), 7, OUTLINE, 2)
    for y in range(22, 100, 4):
        heat = float(rng.uniform(0.8, 1.0))
        canvas.line([(16, y), (112, y)], tint((176, 44, 14), heat), 3.2)
    for x in np.linspace(20, 108, 9):
        canvas.line([(x, 22), (x, 98)], (40, 36, 40), 6.4)
        canvas.line([(x, 23), (x, 97)], tint((255, 132, 36), float(rng.uniform(0.9, 1.05))), 3.6)
    canvas.rectangle(7, 103, 121, 123, tint(metal, 1.25), 8, OUTLINE, 2)
    for x in (28, 52, 76, 100):
        canvas.ellipse((x, 113), (6, 6), (214, 216, 222), OUTLINE, 2)
        canvas.line([(x, 113), (x + float(rng.uniform(-3, 3)), 109)], OUTLINE, 1.8)
    canvas.shade(rng, 0.1, 4)


def cutting_board(canvas: Canvas, rng: np.random.Generator, prepared: bool) -> None:
    """A pale wooden board with a knife along its front edge."""
    wood = vary((240, 206, 146), rng, 8)
    rim = tint(wood, 0.5)
    canvas.rectangle(4, 24, 124, 126, tint(wood, 0.66), 14, rim, 3)
    canvas.rectangle(4, 18, 124, 119, wood, 14, rim, 3)
    for y in np.linspace(30, 110, 9):
        wave = [(x, y + float(rng.normal(0, 0.9))) for x in range(10, 122, 10)]
        canvas.line(wave, tint(wood, float(rng.uniform(0.84, 0.94))), 1.6)
    canvas.ellipse((108, 32), (6.5, 6.5), tint(wood, 0.42), rim, 2)
    blade = [(50, 102), (104, 102), (117, 109), (104, 113), (50, 113)]
    canvas.polygon(blade, (222, 228, 236), (70, 76, 86), 2)
    canvas.line([(54, 110.5), (103, 110.5)], (168, 178, 190), 2)
    canvas.rectangle(13, 101.5, 51, 114, (92, 40, 26), 5, (40, 18, 12), 2)
    for x in (22, 32, 42):
        canvas.ellipse((x, 107.7), (1.8, 1.8), (230, 220, 200))
    canvas.shade(rng, 0.08, 4)


def robot(canvas: Canvas, rng: np.random.Generator, prepared: bool) -> None:
    """A round robot seen from above, looking right: a gripper with two claws in front, eyes behind it."""
    shell = vary((74, 132, 206), rng, 8)
    steel: Color = (176, 184, 196)
    for sign in (-1, 1):
        y = 64 + sign * 17
        claw = [(84, y), (102, 64 + sign * 30), (114, 64 + sign * 29), (124, 64 + sign * 17)]
        canvas.line(claw, OUTLINE, 13)
        canvas.line(claw, steel, 8)
        canvas.line(claw[2:], (232, 92, 60), 8)
        canvas.ellipse(claw[1], (3.4, 3.4), OUTLINE)
    for y in (21, 107):
        canvas.rectangle(36, y - 9, 76, y + 9, (54, 56, 64), 6, OUTLINE, 2.5)
    canvas.ellipse((58, 64), (42, 42), shell, OUTLINE, 3.2)
    canvas.ellipse((56, 64), (33, 33), tint(shell, 1.14), tint(shell, 0.72), 2)
    canvas.line(arc(56, 64, 24, 24, 125, 235), tint(shell, 0.62), 5)
    canvas.ellipse((27, 64), (4.5, 4.5), (250, 214, 84), OUTLINE, 2)
    for y in (50, 78):
        canvas.ellipse((70, y), (10.5, 10.5), (255, 255, 255), OUTLINE, 2.4)
        canvas.ellipse((75, y), (5, 5), (20, 22, 30))
        canvas.ellipse((76.6, y - 1.8), (1.7, 1.7), (255, 255, 255))
    canvas.shade(rng, 0.08, 3)
