"""Draw the states of a domain's demonstrations side by side, with marks and headings, as a model sees them.

python tools/contact_sheet.py coffee three-cups docs/images/coffee.png --demos 0 1
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from PIL import Image

from pix2pred.images import draw_view
from pix2pred.registry import load_domain
from pix2pred.structs import Pixels
from pix2pred.structs.views import View

GAP = 6
"""White pixels between frames."""


def frames(
    domain: str, family: str, seed: int, demos: list[int], tasks: int, side: int, *, marks: bool
) -> list[Pixels]:
    made = load_domain(domain)
    chosen = made.demonstrations(family, seed)
    shown = []
    for index in demos:
        demo = chosen[index]
        titles = ["start", *(a.skill.name for a in demo.actions)]
        for t, (state, title) in enumerate(zip(demo.states, titles, strict=True)):
            view = View(state.pictures[0], t, marks=marks, heading=f"{t}: {title}", longest_side=side)
            shown.append(draw_view(view))
    for stored in made.tasks(family, seed, tasks) if tasks else ():
        pictures = stored.task.initial.pictures
        for picture in pictures:
            heading = stored.task.name if len(pictures) == 1 else f"{stored.task.name}: {picture.camera}"
            shown.append(draw_view(View(picture, 0, marks=marks, heading=heading, longest_side=side)))
    return shown


def sheet(shown: list[Pixels], columns: int) -> Pixels:
    """All frames on one page, row by row; a row is as high as its highest frame."""
    width = max(f.shape[1] for f in shown) + GAP
    rows = [shown[k : k + columns] for k in range(0, len(shown), columns)]
    heights = [max(f.shape[0] for f in row) + GAP for row in rows]
    page = np.full((sum(heights), columns * width, 3), 255, dtype=np.uint8)
    for r, row in enumerate(rows):
        top = sum(heights[:r])
        for k, frame in enumerate(row):
            page[top : top + frame.shape[0], k * width : k * width + frame.shape[1]] = frame
    return page


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("domain")
    parser.add_argument("family")
    parser.add_argument("out", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--demos", type=int, nargs="*", default=[0])
    parser.add_argument("--tasks", type=int, default=0, help="initial states of so many test tasks at the end")
    parser.add_argument("--columns", type=int, default=4)
    parser.add_argument("--side", type=int, default=360)
    parser.add_argument("--no-marks", action="store_true", help="clean pictures, as in domains without marks")
    args = parser.parse_args()
    shown = frames(args.domain, args.family, args.seed, args.demos, args.tasks, args.side, marks=not args.no_marks)
    args.out.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(sheet(shown, args.columns)).save(args.out, optimize=True)


if __name__ == "__main__":
    main()
