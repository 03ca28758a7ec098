"""Draw the pictures of all domains whose marks are hardest to place, each with plain boxes and as a model sees it.

python tools/hard_cases.py docs/images/hard_cases.webp

Left of every pair: what set-of-marks draws without care, a box around every object and its name at the box's corner.
Right: the view of a question, with heading, names, lines and the note on what has no mark. A picture is the harder the
more its boxes overlap and the smaller they are; of a demonstration or task the hardest picture is taken, and crops
around a skill count as pictures of their own.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from contact_sheet import sheet
from pix2pred.images import draw_view, skill_crop
from pix2pred.predicates.prompt import views
from pix2pred.registry import load_domain
from pix2pred.structs import Box, Demo, Object, Pixels, State
from pix2pred.structs.views import View, scale_to

SIDE = 384
FAMILIES = {
    ("burger", "more-stacks"): 4, ("burger", "bigger"): 4, ("burger", "combo"): 3, ("kitchen", "boil"): 4,
    ("coffee", "three-cups"): 5, ("cleanup", "more-objects"): 5, ("juice", "more-objects"): 5,
}  # fmt: skip
"""How many cases come from where."""

SMALL = 24.0
"""Pixels: a side of a box below which pointing at it needs care."""


@dataclass(frozen=True, slots=True)
class Case:
    """A view, where it comes from, and how hard it is."""

    source: str
    view: View
    hardness: float


def hardness(boxes: Mapping[str, Box]) -> float:
    """Overlaps of boxes, as shares of the smaller one, and one half for every small box."""
    overlaps = 0.0
    for a, b in combinations(boxes.values(), 2):
        width = min(a.right, b.right) - max(a.left, b.left)
        height = min(a.bottom, b.bottom) - max(a.top, b.top)
        if width > 0 and height > 0:
            overlaps += width * height / max(1.0, min(a.width * a.height, b.width * b.height))
    return overlaps + sum(min(b.width, b.height) < SMALL for b in boxes.values()) / 2


def cases(domain: str, family: str, seed: int) -> Iterator[Case]:
    """The pictures of the demonstrations with their crops, and those of two tasks; of the latter alone for Juice.

    Juice's demonstrations take minutes to draw, and its tasks show more objects.
    """
    made = load_domain(domain)
    for demo in made.demonstrations(family, seed) if domain != "juice" else ():
        for t, state in enumerate(demo.states):
            yield from _of_state(f"{domain}: {demo.name}", state, t, demo.objects)
            if t:
                yield from _crops(f"{domain}: {demo.name}", demo, t)
    for stored in made.tasks(family, seed, 2):
        yield from _of_state(f"{domain}: {stored.task.name}", stored.task.initial, 0, stored.task.objects)


def _of_state(source: str, state: State, t: int, objects: Sequence[Object]) -> Iterator[Case]:
    for view in views(state, t, objects, marks=True, longest_side=SIDE, after=t - 1 if t else None):
        yield Case(source, view, hardness(shown_boxes(view)))


def _crops(source: str, demo: Demo, t: int) -> Iterator[Case]:
    names = [o.name for o in demo.actions[t - 1].objects]
    for camera, case in enumerate(_of_state(source, demo.states[t], t, demo.objects)):
        size = case.view.picture.image.size
        box = skill_crop(demo.states[t - 1], demo.states[t], names, camera, size)
        if box and max(box.width, box.height) < max(size) / 2:
            close = replace(case.view, crop=box, heading=f"{case.view.heading}, around the skill")
            yield Case(f"{source}, close", close, hardness(shown_boxes(close)))


def shown_boxes(view: View) -> dict[str, Box]:
    """The boxes whose centre is shown, in the pixels of the drawn scene."""
    width, height = view.picture.image.size
    crop = view.crop or Box(0, 0, width, height)
    factor = scale_to(crop.width, crop.height, view.longest_side)
    moved = {
        name: Box(
            (b.left - crop.left) * factor, (b.top - crop.top) * factor,
            (b.right - crop.left) * factor, (b.bottom - crop.top) * factor,
        )
        for name, b in view.boxes.items()
    }  # fmt: skip
    right, bottom = crop.width * factor, crop.height * factor
    return {n: b for n, b in moved.items() if 0 <= b.center[0] < right and 0 <= b.center[1] < bottom}


def plain(view: View) -> Pixels:
    """A box around every object, and its name at the upper left corner."""
    image = Image.fromarray(draw_view(replace(view, marks=False, heading="", unseen=())))
    draw = ImageDraw.Draw(image)
    for name, box in shown_boxes(view).items():
        draw.rectangle((box.left, box.top, box.right, box.bottom), outline=(255, 236, 120))
        left, top, right, bottom = draw.textbbox((box.left + 2, box.top + 1), name)
        draw.rectangle((left - 2, top - 1, right + 2, bottom + 1), fill=(0, 0, 0))
        draw.text((box.left + 2, box.top + 1), name, fill=(255, 236, 120))
    return np.asarray(image, dtype=np.uint8)


def hardest(seed: int, domains: Sequence[str]) -> Iterator[Case]:
    """The cases of the sheet, family by family; one of a demonstration, unless there are too few of these."""
    for (domain, family), count in ((key, count) for key, count in FAMILIES.items() if key[0] in domains):
        found = sorted(cases(domain, family, seed), key=lambda c: (-c.hardness, c.source))
        firsts = [c for i, c in enumerate(found) if c.source not in {d.source for d in found[:i]}]
        yield from [*firsts, *(c for c in found if c not in firsts)][:count]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--domains", nargs="*", default=sorted({domain for domain, _ in FAMILIES}))
    parser.add_argument("--columns", type=int, default=6, help="pictures in a row, two of each case")
    parser.add_argument("--singly", type=Path, help="a folder for the pairs, one file each")
    given = parser.parse_args()
    shown: list[Pixels] = []
    for case in hardest(given.seed, given.domains):
        shown += [plain(case.view), draw_view(case.view)]
        print(f"{case.source}: {case.view.heading} ({case.hardness:.1f})")
    given.out.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(sheet(shown, given.columns)).save(given.out, quality=80, method=6)
    if given.singly:
        given.singly.mkdir(parents=True, exist_ok=True)
        for k in range(0, len(shown), 2):
            Image.fromarray(sheet(shown[k : k + 2], 2)).save(given.singly / f"{k // 2:02}.png")


if __name__ == "__main__":
    main()
