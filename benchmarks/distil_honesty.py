"""What a distilled reader says about things that look otherwise, and about another domain.

    python benchmarks/distil_honesty.py READER --domain burger --family combo --others coffee kitchen

Looks of tasks of other seeds are read as they are and with the colours of every picture turned by a share of the colour
circle. Looks of other domains are read with their objects called what the reader was taught about, one after the other.
The last rows time a look with 50 atoms, pictures decoded anew, in CPU milliseconds.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from distil import World
from pix2pred.predicates.prompt import views
from pix2pred.registry import load_domain
from pix2pred.structs import Image, Object, Picture, State
from pix2pred.vlm.distilled.files import read_reader
from pix2pred.vlm.distilled.model import DistilledModel
from pix2pred.vlm.distilled.regions import Names
from pix2pred.vlm.offline.label_question import Look

TURNS = (0.0, 0.02, 0.05, 0.1, 0.2, 0.5)
SEED = 4000


def turned(picture: Picture, turn: float) -> Picture:
    """The picture with its colours turned: a rotation of red, green and blue about their grey diagonal."""
    c, s = np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)
    same, one, other = c + (1 - c) / 3, (1 - c) / 3 - s / 3**0.5, (1 - c) / 3 + s / 3**0.5
    matrix = np.array([[same, one, other], [other, same, one], [one, other, same]])
    pixels = (picture.image.pixels() @ matrix.T).clip(0, 255).astype(np.uint8)
    return replace(picture, image=Image.from_pixels(pixels))


def look_at(state: State, objects: Sequence[Object]) -> Look:
    shown = views(state, 0, objects, marks=False)
    return Look(tuple(v.picture for v in shown), {o.prompt_name: o.type.name for o in objects})


def atoms_of(model: DistilledModel, look: Look) -> Iterator[tuple[str, Names]]:
    """All atoms about the look's objects that the reader has words for."""
    for word, kinds in model.words:
        for name, kind in sorted(look.types.items()):
            if kind == kinds[0]:
                others = [n for n, t in sorted(look.types.items()) if len(kinds) > 1 and t == kinds[1] and n != name]
                yield from ((word, (name, other)) for other in others) if len(kinds) > 1 else [(word, (name,))]


def recoloured(model: DistilledModel, world: World, count: int) -> Iterator[str]:
    tasks = world.domain.tasks(world.family, SEED, count)
    for task in tasks:
        world.environment(task)
    for turn in TURNS:
        said: Counter[str] = Counter()
        for task in tasks:
            look = look_at(task.task.initial, task.task.objects)
            seen = replace(look, pictures=tuple(turned(p, turn) if turn else p for p in look.pictures))
            atoms = list(atoms_of(model, look))
            for (word, names), reading in zip(atoms, model.read(seen, atoms), strict=True):
                truth = world.holds(look.pictures, word, names)
                if truth is None:
                    continue
                said["atoms"] += 1
                said["answered"] += reading.value is not None
                said["right"] += reading.value is not None and reading.value == truth
        answered, right = said["answered"] / max(1, said["atoms"]), said["right"] / max(1, said["answered"])
        yield f"| colours turned by {turn:.0%} | {answered:.1%} | {right:.1%} | {said['atoms']} |"


def elsewhere(model: DistilledModel, name: str, count: int) -> str:
    domain = load_domain(name)
    taught = sorted({kind for _, kinds in model.words for kind in kinds})
    said: Counter[str] = Counter()
    for task in domain.tasks(domain.families[0], SEED, count):
        look = look_at(task.task.initial, task.task.objects)
        for shift in range(len(taught)):
            types = {n: taught[(i + shift) % len(taught)] for i, n in enumerate(sorted(look.types))}
            other = Look(look.pictures, types)
            atoms = list(atoms_of(model, other))
            said["atoms"] += len(atoms)
            said["answered"] += sum(r.value is not None for r in model.read(other, atoms))
    return f"| {name}, called by its names | {said['answered'] / max(1, said['atoms']):.1%} | | {said['atoms']} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("reader", type=Path)
    parser.add_argument("--domain", default="burger")
    parser.add_argument("--family", default="combo")
    parser.add_argument("--others", nargs="*", default=[])
    parser.add_argument("--tasks", type=int, default=20)
    arguments = parser.parse_args()
    model, _, _ = read_reader(arguments.reader)
    world = World(load_domain(arguments.domain), arguments.family, SEED)
    print("| looks | answered | right | atoms |\n|---|---|---|---|")
    for line in recoloured(model, world, arguments.tasks):
        print(line, flush=True)
    for other in arguments.others:
        print(elsewhere(model, other, arguments.tasks), flush=True)
    task = world.domain.tasks(arguments.family, SEED, 1)[0].task
    look = look_at(task.initial, task.objects)
    atoms = (list(atoms_of(model, look)) * 50)[:50]
    start = time.process_time()
    for _ in range(10):
        model.read(look, atoms)
    print(f"| a look of 50 atoms ({len(set(atoms))} different): {100 * (time.process_time() - start):.1f} ms | | | |")


if __name__ == "__main__":
    main()
