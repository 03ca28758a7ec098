"""What an instance generator gives: a planning problem in plain words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from random import Random


@dataclass
class Instance:
    """Objects by name with their types; atoms written as ``"on b1 b2"``."""

    objects: dict[str, str] = field(default_factory=dict)
    init: list[str] = field(default_factory=list)
    goal: list[str] = field(default_factory=list)

    def add(self, type_name: str, count: int, stem: str | None = None) -> list[str]:
        """Make ``count`` objects of a type, called after ``stem`` (default: the type); their names."""
        stem = stem or type_name
        first = sum(name.rstrip("0123456789") == stem for name in self.objects)
        names = [f"{stem}{first + i + 1}" for i in range(count)]
        self.objects.update(dict.fromkeys(names, type_name))
        return names

    def fact(self, *atoms: str) -> None:
        """Put atoms into the initial state."""
        self.init.extend(atoms)

    def both(self, predicate: str, a: str, b: str) -> None:
        """Put a symmetric relation into the initial state."""
        self.fact(f"{predicate} {a} {b}", f"{predicate} {b} {a}")

    def grid(self, columns: int, rows: int) -> dict[tuple[int, int], str]:
        """Cells ``c<x>x<y>`` with the relation ``beside``."""
        cells = {(x, y): f"c{x}x{y}" for y in range(rows) for x in range(columns)}
        self.objects.update(dict.fromkeys(cells.values(), "cell"))
        for (x, y), name in cells.items():
            for other in ((x + 1, y), (x, y + 1)):
                if other in cells:
                    self.both("beside", name, cells[other])
        return cells

    def connect(self, rng: Random, predicate: str, places: Sequence[str], extra: int) -> None:
        """A random tree over ``places`` and a few more links."""
        linked = {(places[i], rng.choice(places[:i])) for i in range(1, len(places))}
        for _ in range(extra):
            a, b = rng.sample(list(places), 2)
            if (a, b) not in linked and (b, a) not in linked:
                linked.add((a, b))
        for a, b in sorted(linked):
            self.both(predicate, a, b)

    def text(self, name: str, domain: str) -> str:
        """The problem called ``name`` in PDDL."""
        objects = " ".join(f"{name} - {type_name}" for name, type_name in self.objects.items())
        init, goal = (" ".join(f"({atom})" for atom in dict.fromkeys(atoms)) for atoms in (self.init, self.goal))
        return (
            f"(define (problem {name}) (:domain {domain})\n (:objects {objects})\n (:init {init})\n"
            f" (:goal (and {goal})))\n"
        )


def towers(rng: Random, blocks: Sequence[str]) -> list[list[str]]:
    """Random towers, each listed from the bottom."""
    order = rng.sample(list(blocks), len(blocks))
    piles: list[list[str]] = []
    for block in order:
        if piles and rng.random() < 0.6:
            rng.choice(piles).append(block)
        else:
            piles.append([block])
    return piles
