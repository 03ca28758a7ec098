"""Where to look first: labels that are probably wrong, and why they are suspected."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pix2pred.learning import Verdict
from pix2pred.report.contents import Contents
from pix2pred.structs import LabelledDemo

MOST = 60
"""Timelines shown."""

_PROBABILITY = re.compile(r"\b(?:probability|confidence)\b[^0-9]{0,20}([01]?\.\d+|[01])\b", re.IGNORECASE)
_UNSURE = (0.2, 0.8)
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
        if reading.verdict == Verdict.SUPPORTS:
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
    if any(_unsure(contents, demo.name, f"{atom[0]}({', '.join(atom[1:])})", state) for state in states):
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


def _unsure(contents: Contents, demo: str, atom: str, state: int) -> bool:
    """Whether the model gave a middling probability with its answer."""
    for known in contents.evidence.demos:
        if known.name == demo and (numbers := known.why.get(atom)) and numbers[state] >= 0:
            match = _PROBABILITY.search(contents.evidence.explanations[numbers[state]])
            return match is not None and _UNSURE[0] < float(match[1]) < _UNSURE[1]
    return False
