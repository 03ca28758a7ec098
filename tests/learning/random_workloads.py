"""Random selection problems on the burger families: synonyms, antonyms, constants, noise words, flipped labels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from random import Random

import numpy as np

import burger_truth
from pix2pred.structs import Candidate, FromVLM, LabelledDemo, Predicate, TruthTable

FAMILIES = ("more-stacks", "bigger", "combo")
CONCEPTS = {
    "cooked": "cooked", "hand_free": "hand_empty", "chopped": "chopped", "held": "held", "stacked": "stacked",
    "covered": "covered", "on_ground": "on_ground", "occupied": "occupied",
}  # fmt: skip
NEEDED = ("cooked", "hand_free", "chopped")


@dataclass(frozen=True)
class Workload:
    """A table and what each candidate means: a concept, its negation, ``constant`` or ``noise``."""

    table: TruthTable
    meaning: dict[str, str]


@cache
def truth(family: str) -> TruthTable:
    return burger_truth.true_table(family, CONCEPTS)


def random_workload(seed: int) -> Workload:
    """Two to four demonstrations of a family and 10 to 15 candidates; up to 1 % of their labels are flipped."""
    rng = Random(seed)
    source = truth(rng.choice(FAMILIES))
    short = [i for i, d in enumerate(source.demos[:8]) if len(d.actions) < 10]
    indices = sorted(rng.sample(short, min(len(short), rng.randint(2, 4))))
    demos = [_without_bystanders(source.demos[i]) for i in indices]
    flipped = rng.choice((0.0, 0.005, 0.01))
    base = {p.name: p for p in (c.predicate for c in source.pool)}
    words: dict[Predicate, tuple[Predicate, str]] = {}

    def add(kind: str, concept: str) -> None:
        origin = base[concept]
        name = f"w{rng.randrange(10**6):06}_{kind}_{concept}"
        words[Predicate(name, origin.types, FromVLM(name))] = (origin, kind)

    for concept in NEEDED:
        add("same", concept)
    for concept in rng.sample(NEEDED, 2):
        add("same", concept)  # a synonym
    for concept in rng.sample(NEEDED, 2):
        add("not", concept)  # an antonym
    while len(words) < rng.randint(10, 15):
        add(rng.choice(("same", "constant", "noise", "noise")), rng.choice(sorted(base)))
    meaning = {p.name: kind if kind in ("constant", "noise") else f"{kind} {o.name}" for p, (o, kind) in words.items()}
    labels = np.random.default_rng(seed)
    relabelled = tuple(_relabel(d, source, words, flipped, labels) for d in demos)
    pool = tuple(Candidate(p, float(p.arity)) for p in sorted(words))
    return Workload(TruthTable(source.initial, pool, relabelled), meaning)


def _without_bystanders(demo: LabelledDemo) -> LabelledDemo:
    """Only objects that some action or the goal names: smaller tasks of the same difficulty."""
    acted = {o for a in demo.actions for o in a.objects} | {o for a in demo.goal for o in a.objects}
    columns = [i for i, atom in enumerate(demo.atoms) if acted.issuperset(atom.objects)]
    atoms = tuple(demo.atoms[i] for i in columns)
    return LabelledDemo(demo.name, tuple(sorted(acted)), demo.actions, demo.goal, atoms, demo.values[:, columns])


def _relabel(
    demo: LabelledDemo,
    source: TruthTable,
    words: dict[Predicate, tuple[Predicate, str]],
    flipped: float,
    labels: np.random.Generator,
) -> LabelledDemo:
    atoms, columns = [], []
    for i, atom in enumerate(demo.atoms):
        if atom.predicate in source.initial:
            atoms.append(atom)
            columns.append(demo.values[:, i])
    for word, (origin, kind) in words.items():
        for i, atom in enumerate(demo.atoms):
            if atom.predicate == origin:
                values = demo.values[:, i]
                if kind == "not":
                    values = 1 - values
                elif kind == "constant":
                    values = np.ones_like(values)
                elif kind == "noise":
                    values = labels.integers(0, 2, len(values)).astype(np.int8)
                flips = labels.random(len(values)) < flipped
                atoms.append(word(*atom.objects))
                columns.append(np.where(flips, 1 - values, values).astype(np.int8))
    values = np.stack(columns, axis=1)
    return LabelledDemo(demo.name, demo.objects, demo.actions, demo.goal, tuple(atoms), values)
