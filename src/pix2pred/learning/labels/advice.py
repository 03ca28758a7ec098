"""Which labels to check first: those that keep the published learner from the most probable model.

The learner that allows for wrong labels names the predicates the world model should have; of candidates that it takes
for synonyms the selected one stands for all, otherwise the one with the fewest doubted labels, as it is the least work
to put right. If all
doubted labels of these predicates had their likely values, the published learner would find certain operators, and
certain values of J on its way to them. Backward elimination orders the labels by what they do to that: the one that
can best stay as it is comes last, and so on, down to the one that nothing makes up for. Labels that only help together
with others are thus kept together, which adding one at a time would not see.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log
from typing import Any

import numpy as np

from pix2pred.learning.labels.doubts import Doubt, Timeline, doubted
from pix2pred.learning.objective.planning_effort import DemoObjective, DemoScore
from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.operators.transition_class import Lifted
from pix2pred.learning.selection.hill_climbing import Climb, HillClimbing
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.strategies import climbing
from pix2pred.learning.transitions import Extension, IndexedTable
from pix2pred.planning import Strips
from pix2pred.structs import Atom, Label, LabelledDemo, Predicate, TruthTable, Type

MOST_CONSIDERED = 40
"""Labels of which is computed what they do to operators and J; the rest follow by how probably they are wrong."""

NOTHING_LOST = 1e-3
"""A label that brings learning less than this closer to the probable model does nothing."""


@dataclass(frozen=True, slots=True)
class LabelAdvice:
    """A label to check. ``gain`` is how much closer to the probable model its likely value brings, all before set."""

    demo: str
    atom: Atom
    doubt: Doubt
    gain: float


@dataclass(frozen=True, slots=True)
class Advice:
    """What a person should look at.

    ``predicates`` are those of the most probable model; ``labels`` are to be checked, the most useful first.
    """

    predicates: tuple[Predicate, ...]
    labels: tuple[LabelAdvice, ...]


def advise(
    table: TruthTable, settings: LearningSettings, pinned: Sequence[Predicate] = (), selected: Sequence[Predicate] = ()
) -> Advice:
    """The most probable model's predicates and their labels to check; after these come doubts about ``selected``."""
    published = climbing(settings.model_copy(update={"operators": "cluster-and-intersect"}))
    robust = climbing(settings.model_copy(update={"operators": "robust"})).fit(table, pinned)
    identical = dict(robust.identical)
    rivals = {p: (p, *identical.get(p, ())) for p in robust.selected}
    timelines = doubted(table, [q for group in rivals.values() for q in group], unusual=True)
    chosen = {_representative(group, selected, timelines) for group in rivals.values()}
    labels = [(t, d) for t in timelines if t.atom.predicate in chosen for d in t.doubts]
    others = doubted(table, [p for p in selected if p not in chosen], unusual=True)
    rest = [LabelAdvice(t.demo, t.atom, d, 0.0) for t in others for d in t.doubts]
    ordered = _ordered(_only(table, chosen), published, labels)
    return Advice(tuple(sorted(chosen)), (*ordered, *rest))


def advice_document(advice: Advice) -> dict[str, Any]:
    """The JSON form of advice: labels in words."""
    rows = [
        {
            "demo": a.demo,
            "atom": [a.atom.predicate.name, *(o.name for o in a.atom.objects)],
            "state": a.doubt.state,
            "label": a.doubt.label.word,
            "likely": a.doubt.likely.word,
            "probability": round(a.doubt.wrong, 4),
            "gain": round(a.gain, 1),
        }
        for a in advice.labels
    ]
    return {"version": 1, "predicates": [p.name for p in advice.predicates], "labels": rows}


def _representative(
    group: Sequence[Predicate], selected: Sequence[Predicate], timelines: Sequence[Timeline]
) -> Predicate:
    """Of predicates that are the same after repair the selected one: its labels are those that the model is made of.

    Where none or several are selected, the one with the fewest labels expected to be wrong, then the first by name.
    """
    wrong = {p: sum(t.expected for t in timelines if t.atom.predicate == p) for p in group}
    return min(group, key=lambda p: (p not in selected, round(wrong[p], 6), p))


def _only(table: TruthTable, chosen: set[Predicate]) -> TruthTable:
    kept = (*table.initial, *chosen)
    pool = tuple(c for c in table.pool if c.predicate in chosen)
    return TruthTable(table.initial, pool, tuple(d.restricted(kept) for d in table.demos))


def _ordered(table: TruthTable, published: HillClimbing, labels: Sequence[tuple[Timeline, Doubt]]) -> list[LabelAdvice]:
    """By backward elimination; labels that do nothing, alone or with others, follow by how probably they are wrong."""
    if not labels:
        return []
    by_doubt = sorted(labels, key=lambda x: (-round(x[1].wrong, 6), x[0].demo, x[0].atom, x[1].state))
    considered, later = by_doubt[:MOST_CONSIDERED], by_doubt[MOST_CONSIDERED:]
    found = _eliminated(_Distance(table, published, labels), considered)
    return [LabelAdvice(t.demo, t.atom, d, gain) for (t, d), gain in (*found, *((x, 0.0) for x in later))]


def _eliminated(
    learning: _Distance, considered: Sequence[tuple[Timeline, Doubt]]
) -> list[tuple[tuple[Timeline, Doubt], float]]:
    """The labels, the one that can be spared least first, each with what it gains when those before it are set."""
    left = list(range(len(considered)))
    last: list[tuple[int, float]] = []
    distance = learning.distance(considered)

    def without(i: int) -> float:
        return learning.distance([considered[k] for k in left if k != i])

    for i in reversed(range(len(considered))):
        if abs(without(i) - distance) < NOTHING_LOST:
            left.remove(i)
            last.append((i, 0.0))
    while left:
        lost = {i: without(i) - distance for i in left}
        spared = min(left, key=lambda i: (round(lost[i] * considered[i][1].wrong, 4), -i))
        left.remove(spared)
        last.append((spared, lost[spared]))
        distance += lost[spared]
    return [(considered[i], gain) for i, gain in reversed(last)]


class _Distance:
    """How far the published learner is from the probable model, with some of the doubted labels set."""

    def __init__(self, table: TruthTable, published: HillClimbing, labels: Sequence[tuple[Timeline, Doubt]]) -> None:
        self._data = IndexedTable(table)
        self._demos = {demo.name: d for d, demo in enumerate(table.demos)}
        self._objects = {o: i for i, o in enumerate(self._data.objects)}
        self._published = replace(published, objective=_Remembered(published.objective))
        climb = self._climb(labels)
        path = [step.added for step in climb.run().steps if step.added]
        self._path = [*path, *(c.predicate for c in table.candidates() if c.predicate not in path)]
        self._target = _operators(climb.model)

    def distance(self, labels: Sequence[tuple[Timeline, Doubt]]) -> float:
        """Operators that differ, and log J of the sets of predicates on the way to the probable model."""
        climb = self._climb(labels)
        j = [climb.score(self._path[: k + 1]).total for k in range(len(self._path))]
        return sum(log(max(x, 1.0)) for x in j) + len(_operators(climb.model) ^ self._target)

    def _climb(self, labels: Sequence[tuple[Timeline, Doubt]]) -> Climb:
        return self._published.start(self._data.relabelled(self._likely(labels)))

    def _likely(self, labels: Sequence[tuple[Timeline, Doubt]]) -> dict[int, list[list[Extension]]]:
        """By predicate, demonstration and state what is true when ``labels`` have their likely values."""
        data = self._data
        values: dict[int, list[list[Extension]]] = {}
        for timeline, doubt in labels:
            p = data.predicates.index(timeline.atom.predicate)
            if p not in values:
                values[p] = [[data.extension(d, s, p) for s in range(demo.states)] for d, demo in enumerate(data.demos)]
            states = values[p][self._demos[timeline.demo]]
            args = {tuple(self._objects[o] for o in timeline.atom.objects)}
            before = states[doubt.state]
            states[doubt.state] = before | args if doubt.likely == Label.TRUE else before - args
        return values


class _Remembered:
    """J of a demonstration, not computed twice: most labels change the tasks of few demonstrations."""

    def __init__(self, of_demo: DemoObjective) -> None:
        self._of_demo = of_demo
        self.near_tie = of_demo.near_tie
        self._known: dict[tuple[Strips | None, int], DemoScore] = {}

    def __call__(self, task: Strips | None, states: int, bound: float) -> DemoScore:
        known = self._known.get((task, states))
        if known is None or not (known.exact or known.value > bound):
            known = self._known[task, states] = self._of_demo(task, states, bound)
        return known


_Rule = tuple[int, tuple[Type, ...], tuple[int, ...], frozenset[Lifted], frozenset[Lifted], frozenset[Lifted]]


def _operators(model: OperatorModel) -> frozenset[_Rule]:
    """The operators over all candidates, without their numbers and support."""
    everything = range(len(model.data.predicates))
    return frozenset(
        (s.cls.skill, s.cls.types, s.cls.skill_args, frozenset(s.pre), frozenset(s.cls.add), frozenset(s.cls.delete))
        for s in model.schemas(model.partition(everything), everything)
    )


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
