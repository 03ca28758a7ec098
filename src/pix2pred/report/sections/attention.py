"""Where to look first: labels that are probably wrong, and why they are suspected."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pix2pred.learning import SupportKind
from pix2pred.report.contents import Contents
from pix2pred.structs import Label, LabelledDemo

MOST = 60
"""Timelines shown."""

_PROBABILITY = re.compile(r"\b(?:probability|confidence)\b[^0-9]{0,20}([01]?\.\d+|[01])\b", re.IGNORECASE)
_UNSURE = (0.2, 0.8)
"""Probabilities of "true" between which a model is unsure; labels that it gives a lower one than the upper are."""

_LETTERS = {"true": "1", "false": "0", "unknown": "?"}

Broken = Mapping[tuple[str, int, str], set[str]]
"""Operators that a transition contradicts, by (demonstration, state, atom) of what differs."""


@dataclass(frozen=True, slots=True)
class Suspicion:
    """An atom's doubted labels in one demonstration, as rows of the run's advice.

    ``text`` is the atom as it is called now, ``atom`` the model's name for its predicate and the objects.
    """

    demo: str
    text: str
    atom: tuple[str, ...]
    labels: tuple[Mapping[str, Any], ...]
    reasons: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """JSON-compatible; labels are 1, 0 and ? as in the tables."""
        return {
            "demo": self.demo,
            "atom": list(self.atom),
            "text": self.text,
            "doubts": [
                [r["state"], _LETTERS[r["label"]], _LETTERS[r["likely"]], r["probability"]] for r in self.labels
            ],
            "reasons": list(self.reasons),
        }


@dataclass(frozen=True, slots=True)
class Unsure:
    """A label to which the model itself gave a low ``confidence``; names as in ``Suspicion``."""

    demo: str
    text: str
    atom: tuple[str, ...]
    state: int
    label: str
    confidence: float


def unsure(contents: Contents) -> list[Unsure]:
    """Labels of selected predicates, and of those the advice names, that the model was unsure of, the least sure first.

    What a person has looked at and what is suspected anyway is left out. Known where answers were voted on, or came
    with their probabilities.
    """
    advised = {(r["demo"], r["state"], tuple(r["atom"])) for r in contents.advice["labels"]}
    names = {p.name for p in contents.model.selected} | set(contents.advice["predicates"])
    found = []
    for demo in contents.table.demos:
        if demo.confidence is None:
            continue
        columns = [i for i, a in enumerate(demo.atoms) if a.predicate.name in names]
        for state, i in np.argwhere(demo.confidence[:, columns] < _UNSURE[1]):
            atom, confidence = demo.atoms[columns[i]], float(demo.confidence[state, columns[i]])
            objects = tuple(o.name for o in atom.objects)
            original = (contents.original(atom.predicate.name), *objects)
            known = (demo.name, int(state), original) in contents.corrections.labels
            if not known and (demo.name, int(state), (atom.predicate.name, *objects)) not in advised:
                label = Label(demo.values[state, columns[i]]).word
                found.append(Unsure(demo.name, str(atom), original, int(state), label, confidence))
    return sorted(found, key=lambda u: (u.confidence, u.demo, u.atom, u.state))[:MOST]


def suspicions(contents: Contents) -> list[Suspicion]:
    """The labels of the run's advice by atom, in its order; those that a person has looked at are left out."""
    groups: dict[tuple[str, tuple[str, ...]], list[Mapping[str, Any]]] = defaultdict(list)
    for row in contents.advice["labels"]:
        atom = (contents.original(row["atom"][0]), *row["atom"][1:])
        if (row["demo"], row["state"], atom) not in contents.corrections.labels:
            groups[row["demo"], atom].append(row)
    broken = _broken(contents)
    demos = {demo.name: demo for demo in contents.table.demos}
    found = []
    for (name, atom), rows in list(groups.items())[:MOST]:
        text = f"{rows[0]['atom'][0]}({', '.join(atom[1:])})"
        reasons = _reasons(contents, demos[name], text, atom, rows, broken)
        found.append(Suspicion(name, text, atom, tuple(sorted(rows, key=lambda r: r["state"])), reasons))
    return found


def _broken(contents: Contents) -> Broken:
    broken: dict[tuple[str, int, str], set[str]] = defaultdict(set)
    for reading in contents.readings:
        if reading.verdict == SupportKind.SUPPORTS:
            continue
        for atom in reading.unmet:
            broken[reading.demo, reading.step, atom].add(reading.operator)
        for change in (*reading.absent, *reading.surplus):
            for state in (reading.step, reading.step + 1):
                broken[reading.demo, state, change[1:]].add(reading.operator)
    return broken


def _reasons(
    contents: Contents,
    demo: LabelledDemo,
    text: str,
    atom: tuple[str, ...],
    rows: Sequence[Mapping[str, Any]],
    broken: Broken,
) -> tuple[str, ...]:
    reasons = []
    states = [row["state"] for row in rows]
    if any(_flips(demo, text, set(atom[1:]), state) for state in states):
        reasons.append("flips without a cause")
    if any(row["label"] == "unknown" for row in rows):
        reasons.append("unknown")
    said = f"{atom[0]}({', '.join(atom[1:])})"
    if any(_low(demo, text, state) or _says_unsure(contents, demo.name, said, state) for state in states):
        reasons.append("the model was unsure")
    operators = {op for state in states for op in broken.get((demo.name, state, text), ())}
    if operators:
        reasons.append(f"contradicts {', '.join(sorted(operators, key=lambda n: (len(n), n)))}")
    return tuple(reasons) or ("unlike the other demonstrations",)


def _flips(demo: LabelledDemo, text: str, objects: set[str], state: int) -> bool:
    """Whether the label differs from one beside it although the skill between has none of the atom's objects."""
    column = next((i for i, a in enumerate(demo.atoms) if str(a) == text), None)
    if column is None:
        return False
    values = np.asarray(demo.values[:, column])
    return any(
        values[step] != values[step + 1] and not objects & {o.name for o in demo.actions[step].objects}
        for step in (state - 1, state)
        if 0 <= step < len(demo.actions)
    )


def _low(demo: LabelledDemo, text: str, state: int) -> bool:
    """Whether votes or token probabilities gave the label a low confidence."""
    column = next((i for i, a in enumerate(demo.atoms) if str(a) == text), None)
    return column is not None and demo.confidence is not None and bool(demo.confidence[state, column] < _UNSURE[1])


def _says_unsure(contents: Contents, demo: str, atom: str, state: int) -> bool:
    """Whether the model gave a middling probability with its answer."""
    for known in contents.evidence.demos:
        if known.name == demo and (numbers := known.why.get(atom)) and numbers[state] >= 0:
            match = _PROBABILITY.search(contents.evidence.explanations[numbers[state]])
            return match is not None and _UNSURE[0] < float(match[1]) < _UNSURE[1]
    return False
