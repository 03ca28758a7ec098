"""Which labels to check first: those that keep the published learner from the most probable model.

The learner that allows for wrong labels names the predicates the world model should have; of candidates that it takes
for synonyms, the one with the fewest doubted labels stands for all, as it is the least work to put right. The doubted
labels of these predicates are then ordered greedily: next comes the one whose likely value brings J and the operators
of the published learner closest to those of the probable model.
"""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, log
from typing import Any

import numpy as np

from pix2pred.learning.doubts import Doubt, Timeline, doubted
from pix2pred.learning.engines import hill_climbing, learn_operators
from pix2pred.learning.settings import LearningSettings
from pix2pred.structs import FALSE, TRUE, UNKNOWN, Atom, LabelledDemo, Operator, Predicate, TruthTable

MOST_CONSIDERED = 40
"""Labels of which is computed what they do to operators and J."""

MOST_ORDERED = 12
"""Labels ordered by what they do to operators and J; the rest follow by how probably they are wrong."""


@dataclass(frozen=True, slots=True)
class LabelAdvice:
    """A label to check. ``gain`` is how much closer to the probable model its likely value brings, all before set."""

    demo: str
    atom: Atom
    doubt: Doubt
    gain: float


@dataclass(frozen=True, slots=True)
class Advice:
    """Predicates that the most probable model selects, and labels to check, the most useful first."""

    predicates: tuple[Predicate, ...]
    labels: tuple[LabelAdvice, ...]


def advise(
    table: TruthTable,
    settings: LearningSettings,
    pinned: Sequence[Predicate] = (),
    selected: Sequence[Predicate] = (),
) -> Advice:
    """The most probable model's predicates and their labels to check; after these come doubts about ``selected``."""
    settings = settings.model_copy(update={"operators": "cluster-and-intersect"})
    robust = hill_climbing(table, settings.model_copy(update={"operators": "robust"}), pinned=pinned).run()
    identical = dict(robust.identical)
    rivals = {p: (p, *identical.get(p, ())) for p in robust.selected}
    timelines = doubted(table, [q for group in rivals.values() for q in group], unusual=True)
    chosen = {_cleanest(group, timelines) for group in rivals.values()}
    labels = [(t, d) for t in timelines if t.atom.predicate in chosen for d in t.doubts]
    others = doubted(table, [p for p in selected if p not in chosen], unusual=True)
    rest = [LabelAdvice(t.demo, t.atom, d, 0.0) for t in others for d in t.doubts]
    ordered = _ordered(_only(table, chosen), settings, labels)
    return Advice(tuple(sorted(chosen)), (*ordered, *rest))


def advice_document(advice: Advice) -> dict[str, Any]:
    """The JSON form of advice: labels in words."""
    words = {TRUE: "true", FALSE: "false", UNKNOWN: "unknown"}
    rows = [
        {
            "demo": a.demo,
            "atom": [a.atom.predicate.name, *(o.name for o in a.atom.objects)],
            "state": a.doubt.state,
            "label": words[a.doubt.label],
            "likely": words[a.doubt.likely],
            "probability": round(a.doubt.wrong, 4),
            "gain": round(a.gain, 1),
        }
        for a in advice.labels
    ]
    return {"version": 1, "predicates": [p.name for p in advice.predicates], "labels": rows}


def _cleanest(group: Sequence[Predicate], timelines: Sequence[Timeline]) -> Predicate:
    """The predicate with the fewest labels expected to be wrong, the first by name of several."""
    wrong = {p: sum(t.expected for t in timelines if t.atom.predicate == p) for p in group}
    return min(group, key=lambda p: (round(wrong[p], 6), p))


def _only(table: TruthTable, chosen: set[Predicate]) -> TruthTable:
    kept = (*table.initial, *chosen)
    pool = tuple(c for c in table.pool if c.predicate in chosen)
    return TruthTable(table.initial, pool, tuple(d.restricted(kept) for d in table.demos))


def _ordered(
    table: TruthTable, settings: LearningSettings, labels: Sequence[tuple[Timeline, Doubt]]
) -> list[LabelAdvice]:
    """Greedily by expected gain; a label's gain is computed again only when it might be the best (lazy greedy)."""
    by_doubt = sorted(labels, key=lambda x: (-round(x[1].wrong, 6), x[0].demo, x[0].atom, x[1].state))
    considered, later = by_doubt[:MOST_CONSIDERED], by_doubt[MOST_CONSIDERED:]
    likely = with_labels(table, {(t.demo, t.atom, d.state): d.likely for t, d in labels})
    target = _operators(likely, settings)
    current = _distance(table, settings, target)
    queue = [(-inf, -1, i) for i in range(len(considered))]
    advice: list[LabelAdvice] = []
    while queue and len(advice) < MOST_ORDERED:
        _, _, i = heapq.heappop(queue)
        timeline, doubt = considered[i]
        gain = current - _distance(_with(table, timeline, doubt), settings, target)
        entry = (-round(gain * doubt.wrong, 4), len(advice), i)
        if queue and entry > queue[0]:
            heapq.heappush(queue, entry)
            continue
        table = _with(table, timeline, doubt)
        advice.append(LabelAdvice(timeline.demo, timeline.atom, doubt, gain))
        current -= gain
    rest = [considered[i] for i in sorted(i for _, _, i in queue)]
    return advice + [LabelAdvice(t.demo, t.atom, d, 0.0) for t, d in (*rest, *later)]


def _distance(table: TruthTable, settings: LearningSettings, target: frozenset[Operator]) -> float:
    """How far learning is from the probable model: log J with all candidates, and operators that differ."""
    climb = hill_climbing(table, settings)
    j = climb.score([c.predicate for c in table.candidates()]).total
    return round(log(max(j, 1.0)) + len(_operators(table, settings) ^ target), 4)


def _operators(table: TruthTable, settings: LearningSettings) -> frozenset[Operator]:
    """The operators over all candidates, without their numbers and support."""
    return frozenset(replace(op, name="", support=0) for op in learn_operators(table, settings))


def _with(table: TruthTable, timeline: Timeline, doubt: Doubt) -> TruthTable:
    return with_labels(table, {(timeline.demo, timeline.atom, doubt.state): doubt.likely})


def with_labels(table: TruthTable, labels: Mapping[tuple[str, Atom, int], int]) -> TruthTable:
    """``table`` with other values for some labels, by (demonstration, atom, state)."""
    demos: list[LabelledDemo] = []
    for demo in table.demos:
        mine = {(atom, state): value for (name, atom, state), value in labels.items() if name == demo.name}
        if mine:
            values = np.array(demo.values)
            for (atom, state), value in mine.items():
                values[state, demo.atoms.index(atom)] = value
            demo = replace(demo, values=values)
        demos.append(demo)
    return TruthTable(table.initial, table.pool, tuple(demos))
