"""A small world of lamps and boxes, drawn in numpy, with which readers are taught in a second."""

from __future__ import annotations

from functools import cache

import numpy as np

from pix2pred.structs import Box, Image, Picture
from pix2pred.vlm.distilled.fitting.fit import Fitted, fit
from pix2pred.vlm.distilled.fitting.lesson import Example, FitSettings, Lesson
from pix2pred.vlm.offline.label_question import Look

SIDE, LAMP = 96, 20
BRIGHT, DARK, WALL, TRAY = (250, 220, 60), (70, 60, 50), (120, 140, 160), (160, 60, 60)
TYPES = {"lamp1": "lamp", "lamp2": "lamp", "tray": "tray"}
SETTINGS = FitSettings(copies=1, folds=6)


def look_at(
    lit: dict[str, bool], places: dict[str, tuple[int, int]], rng: np.random.Generator, bright: tuple[int, ...] = BRIGHT
) -> Look:
    """Lamps that shine or not, at their places, and a tray, on a noisy wall."""
    pixels = np.empty((SIDE, SIDE, 3))
    pixels[:] = WALL
    boxes = {}
    for name, (x, y) in places.items():
        width = LAMP * 2 if name == "tray" else LAMP
        area = pixels[y : y + LAMP, x : x + width]
        area[:] = TRAY if name == "tray" else bright if lit[name] else DARK
        area[4:8, 4:8] = 200
        boxes[name] = Box(x, y, x + width, y + LAMP)
    noisy = (pixels + rng.normal(0, 4, pixels.shape)).clip(0, 255).astype(np.uint8)
    return Look((Picture("front", Image.from_pixels(noisy), boxes),), TYPES)


def drawn(rng: np.random.Generator, bright: tuple[int, ...] = BRIGHT) -> tuple[Look, dict[tuple[str, ...], bool]]:
    """A look drawn by chance, and what is true in it: ``lit(lamp)`` and ``above(lamp, tray)``."""
    lit = {name: bool(rng.random() < 0.5) for name in ("lamp1", "lamp2")}
    x, y = int(rng.integers(4, 50)), 40
    above = {name: bool(rng.random() < 0.5) for name in lit}
    places = {"tray": (x, y)}
    for i, name in enumerate(lit):
        places[name] = (x + 20 * i, y - LAMP - 2 if above[name] else y + LAMP + 8)
    truth: dict[tuple[str, ...], bool] = {}
    for name in lit:
        truth |= {("lit", name): lit[name], ("above", name, "tray"): above[name]}
    return look_at(lit, places, rng, bright), truth


def lesson(seed: int, groups: int = 8, each: int = 5, wrong: float = 0.0) -> Lesson:
    """Looks of several demonstrations with their labels, a share of which is wrong."""
    rng = np.random.default_rng(seed)
    looks, names, examples = [], [], []
    for group in range(groups):
        for _ in range(each):
            look, truth = drawn(rng)
            looks.append(look)
            names.append(f"demo {group}")
            for (word, *args), value in truth.items():
                examples.append(Example(len(looks) - 1, word, tuple(args), value != (rng.random() < wrong)))
    return Lesson(looks, names, examples)


@cache
def taught(wrong: float = 0.05) -> Fitted:
    """A reader of lamps, taught with a share of wrong labels."""
    return fit(lesson(1, wrong=wrong), SETTINGS)
