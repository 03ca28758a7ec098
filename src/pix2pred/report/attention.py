"""Where to look first: labels that are probably wrong, why they are suspected, and what they would change."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import numpy as np

from pix2pred.learning import Timeline, Verdict
from pix2pred.report.contents import Contents
from pix2pred.structs import FALSE, TRUE, LabelledDemo

MOST = 60
"""Timelines shown."""

_PROBABILITY = re.compile(r"\b(?:probability|confidence)\b[^0-9]{0,20}([01]?\.\d+|[01])\b", re.IGNORECASE)
_UNSURE = (0.2, 0.8)


@dataclass(frozen=True, slots=True)
class Suspicion:
    """An atom's doubted labels in one demonstration. ``predicate`` is the model's name for it."""

    timeline: Timeline
    predicate: str
    weight: float
    reasons: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """JSON-compatible; labels are 1, 0 and ? as in the tables."""
        return {
            "demo": self.timeline.demo,
            "atom": [self.predicate, *(o.name for o in self.timeline.atom.objects)],
            "text": str(self.timeline.atom),
            "doubts": [[d.state, _letter(d.label), _letter(d.likely), round(d.wrong, 4)] for d in self.timeline.doubts],
            "reasons": list(self.reasons),
        }


def suspicions(contents: Contents) -> list[Suspicion]:
    """The most useful timelines to check, first the one with the most at stake.

    A timeline counts for the number of its labels that are expected to be wrong, and double for predicates that the
    world model uses.
    """
    broken = _broken(contents)
    used = set(contents.model.predicates)
    demos = {demo.name: demo for demo in contents.table.demos}
    confirmed = {(c[0], c[1], c[2]) for c in contents.learned_corrections.labels}
    found = []
    for timeline in contents.doubts:
        predicate = contents.original(timeline.atom.predicate)
        cell = (predicate, *(o.name for o in timeline.atom.objects))
        doubts = tuple(d for d in timeline.doubts if (timeline.demo, d.state, cell) not in confirmed)
        if not doubts:
            continue
        open_ = Timeline(timeline.demo, timeline.atom, doubts)
        in_model = timeline.atom.predicate in used
        reasons = _reasons(contents, demos[timeline.demo], open_, predicate, broken) if in_model else ()
        reasons = reasons or _reasons(contents, demos[timeline.demo], open_, predicate, {})
        found.append(Suspicion(open_, predicate, open_.expected * (2 if in_model else 1), reasons))
    return sorted(found, key=lambda s: (-round(s.weight, 6), s.timeline.demo, s.timeline.atom))[:MOST]


def _broken(contents: Contents) -> dict[tuple[str, int, str], set[str]]:
    """Operators that a transition contradicts, by (demonstration, state, atom) of what differs."""
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
    timeline: Timeline,
    predicate: str,
    broken: dict[tuple[str, int, str], set[str]],
) -> tuple[str, ...]:
    reasons = []
    if any(_flips(demo, timeline, d.state) for d in timeline.doubts):
        reasons.append("flips without a cause")
    if any(d.label not in (TRUE, FALSE) for d in timeline.doubts):
        reasons.append("unknown")
    if any(_unsure(contents, timeline, predicate, d.state) for d in timeline.doubts):
        reasons.append("the model was unsure")
    operators = {op for d in timeline.doubts for op in broken.get((timeline.demo, d.state, str(timeline.atom)), ())}
    if operators:
        reasons.append(f"contradicts {', '.join(sorted(operators, key=lambda n: (len(n), n)))}")
    return tuple(reasons)


def _flips(demo: LabelledDemo, timeline: Timeline, state: int) -> bool:
    """Whether the label differs from one beside it although the skill between has none of the atom's objects."""
    column = demo.atoms.index(timeline.atom)
    values = np.asarray(demo.values[:, column])
    for step in (state - 1, state):
        if 0 <= step < len(demo.actions) and values[step] != values[step + 1]:
            if not set(demo.actions[step].objects) & set(timeline.atom.objects):
                return True
    neighbours = [values[s] for s in (state - 1, state + 1) if 0 <= s < len(values)]
    return len(neighbours) == 2 and all(n != values[state] for n in neighbours)


def _unsure(contents: Contents, timeline: Timeline, predicate: str, state: int) -> bool:
    """Whether the model gave a middling probability with its answer."""
    objects = ", ".join(o.name for o in timeline.atom.objects)
    for demo in contents.evidence.demos:
        if demo.name == timeline.demo and (numbers := demo.why.get(f"{predicate}({objects})")):
            number = numbers[state]
            match = _PROBABILITY.search(contents.evidence.explanations[number]) if number >= 0 else None
            return match is not None and _UNSURE[0] < float(match[1]) < _UNSURE[1]
    return False


def _letter(value: int) -> str:
    return {TRUE: "1", FALSE: "0"}.get(value, "?")
