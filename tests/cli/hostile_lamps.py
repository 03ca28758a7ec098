"""A project of two lamps, learned in a blink, and a model whose answers a test decides; also a program (``main``)."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import PIL.Image

from pix2pred.registry import Registry
from pix2pred.vlm import VLM, Answer, Purpose, Request
from pix2pred.vlm.model_spec import MadeSpec, ModelSpec
from pix2pred.vlm.offline.prompt_format import asked_atoms, current_views

DOMAIN = """\
format: pix2pred-domain
version: 1
name: lamps
types:
- {name: robot}
- {name: lamp, features: [x]}
- {name: plug}
objects:
  robby: {type: robot}
  l1: {type: lamp}
  l2: {type: lamp}
skills:
- {name: Press, types: [robot, lamp]}
predicates:
- {name: Done, types: [lamp], source: human}
learning: {max_plans: 2, operators: cluster-and-intersect}
"""
DEMO = """\
format: pix2pred-demo
version: 1
objects: [robby, l1, l2]
goal: ["Done(l1)", "Done(l2)"]
actions:
- Press(robby, l1)
- Press(robby, l2)
states:
- features: {l1: [0], l2: [0]}
  given: []
  pictures: {main: {l1: [0, 0, 20, 20], l2: [20, 0, 40, 20], robby: [0, 20, 40, 30]}}
- features: {l1: [0], l2: [0]}
  given: ["Done(l1)"]
  pictures: {main: {l1: [0, 0, 20, 20], l2: [20, 0, 40, 20], robby: [0, 20, 40, 30]}}
- features: {l1: [0], l2: [0]}
  given: ["Done(l1)", "Done(l2)"]
  pictures: {main: {l1: [0, 0, 20, 20], l2: [20, 0, 40, 20], robby: [0, 20, 40, 30]}}
"""
TASK = """\
format: pix2pred-task
version: 1
objects:
  robby: {type: robot}
  l1: {type: lamp}
  l2: {type: lamp}
goal: ["Done(l1)", "Done(l2)"]
state:
  features: {l1: [0], l2: [0]}
  given: []
  pictures: {main: {l1: [0, 0, 20, 20], l2: [20, 0, 40, 20], robby: [0, 20, 40, 30]}}
"""


def png(lit: int = 0, width: int = 40, height: int = 30, shade: int = 40) -> bytes:
    """A picture whose first ``lit`` lamps are bright."""
    pixels = np.full((height, width, 3), shade, np.uint8)
    pixels[:20, : 20 * lit] = 220
    buffer = io.BytesIO()
    PIL.Image.fromarray(pixels).save(buffer, "PNG")
    return buffer.getvalue()


def write_lamps(root: Path, demos: int = 2) -> Path:
    """The project folder."""
    root.mkdir(parents=True)
    (root / "domain.yaml").write_text(DOMAIN)
    for d in range(demos):
        folder = root / "demos" / f"d{d}"
        for t in range(3):
            (folder / "images" / str(t)).mkdir(parents=True)
            (folder / "images" / str(t) / "main.png").write_bytes(png(t, shade=40 + d))
        (folder / "demo.yaml").write_text(DEMO)
    (root / "tasks/t0/images/0").mkdir(parents=True)
    (root / "tasks/t0/images/0/main.png").write_bytes(png(0))
    (root / "tasks/t0/task.yaml").write_text(TASK)
    return root


def sees(request: Request) -> str:
    """An honest answer: ``lit`` is read from the pixels."""
    if request.purpose == Purpose.PROPOSE:
        return "* lit(l1)\n* near(robby, l2)\n"
    view = current_views(request.views)[0]
    pixels = view.picture.image.pixels()
    lines = []
    for atom in asked_atoms(request.text):
        boxes = [view.boxes[name] for name in atom.names if name in view.boxes]
        bright = atom.word == "lit" and all(pixels[int(b.center[1]), int(b.center[0]), 0] > 128 for b in boxes)
        lines.append(f"* {atom}: {bright}. As seen.")
    return "\n".join(lines)


Say = Callable[[Request], str]


@dataclass
class Fake:
    """Implements ``VLM``: answers ``propose`` to proposals and ``label`` to everything else."""

    propose: Say = sees
    label: Say = sees
    name: str = "fake:1"
    asked: list[Request] = field(default_factory=list)

    def answer(self, request: Request) -> Answer:
        self.asked.append(request)
        return Answer((self.propose if request.purpose == Purpose.PROPOSE else self.label)(request))


@dataclass
class OneModel(Registry):
    """A registry in which every ``--vlm`` is ``model``."""

    model: VLM

    def model_spec(self, text: str) -> ModelSpec:
        return MadeSpec(lambda _: self.model, text)


def main() -> None:
    """``python hostile_lamps.py SECONDS verb ...``: the command line with a model that takes SECONDS an answer."""
    import time

    from pix2pred.cli.app import main as command_line

    seconds = float(sys.argv[1])

    def slow(request: Request) -> str:
        time.sleep(seconds)
        return sees(request)

    command_line(sys.argv[2:], OneModel(Fake(slow, slow)))


if __name__ == "__main__":
    main()
