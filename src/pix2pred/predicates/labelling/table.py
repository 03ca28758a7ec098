"""From demonstrations and a pool of predicates to the truth table (method 3.7)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from pix2pred.predicates.initial import is_asked, local_values
from pix2pred.predicates.labelling.asking import Gap, Occurrence
from pix2pred.predicates.labelling.state_labels import StateLabeller, StateLabels, UnusableAnswersError
from pix2pred.structs import (
    Atom,
    Candidate,
    Demo,
    LabelledDemo,
    Object,
    Predicate,
    TruthTable,
    count_groundings,
    groundings,
)
from pix2pred.structs.goals.opposites import holds
from pix2pred.system.errors import Pix2predError
from pix2pred.system.progress import Progress, Stage, silent


@dataclass(frozen=True, slots=True)
class Labelling:
    """The truth table, the answers it was read from, counts of what could not be used, and atoms without a value."""

    table: TruthTable
    answers: tuple[tuple[StateLabels, ...], ...]
    counts: Counter[Occurrence]
    gaps: tuple[Gap, ...] = ()


MOST_ATOMS = 1_000_000
"""Atoms of one scene that are made at all: some hundred bytes each."""


def label_demos(
    demos: Sequence[Demo],
    initial: Sequence[Predicate],
    pool: Sequence[Candidate],
    labeller: StateLabeller,
    *,
    progress: Progress = silent,
    max_atoms: int = MOST_ATOMS,
) -> Labelling:
    """Label every atom of ``initial`` and ``pool`` in every state; states of a demonstration in order.

    ``labeller.together`` says how much is asked at once. Raises ``TooManyAtomsError`` before the first question when a
    demonstration has more than ``max_atoms``, and ``UnusableAnswersError`` when no answer holds a label.
    """
    predicates = (*initial, *(c.predicate for c in pool))
    labelled: list[LabelledDemo] = []
    answers: list[tuple[StateLabels, ...]] = []
    for demo in demos:
        refuse_too_many(predicates, demo.objects, max_atoms)
    work = labeller.together.map(lambda demo: _label_demo(demo, predicates, labeller), demos)
    for demo, (one, texts) in zip(demos, work, strict=True):
        labelled.append(one)
        answers.append(texts)
        progress(Stage.LABEL, len(labelled), len(demos), demo.name)
    states = [s for texts in answers for s in texts]
    counts = sum((s.counts for s in states), Counter[Occurrence]())
    gaps = tuple(gap for s in states for gap in s.gaps)
    if gaps and not counts[Occurrence.READ]:
        raise UnusableAnswersError.after(labeller.vlm.name, states)
    return Labelling(TruthTable(tuple(initial), tuple(pool), tuple(labelled)), tuple(answers), counts, gaps)


def _label_demo(
    demo: Demo, predicates: Iterable[Predicate], labeller: StateLabeller
) -> tuple[LabelledDemo, tuple[StateLabels, ...]]:
    atoms = ground_atoms(predicates, demo.objects)
    asked = [a for a in atoms if is_asked(a)]
    answers = labeller.demo(demo, asked) if asked else ()
    values = np.zeros((len(demo.states), len(atoms)), dtype=np.int8)
    confidence = np.full(values.shape, np.nan, dtype=np.float32)
    for i, atom in enumerate(atoms):
        if is_asked(atom):
            values[:, i] = [labels.values[atom] for labels in answers]
            confidence[:, i] = [labels.confidence.get(atom, np.nan) for labels in answers]
        else:
            values[:, i] = local_values(atom, demo.states, demo.actions)
    known = confidence if np.isfinite(confidence).any() else None
    one = LabelledDemo(demo.name, demo.objects, demo.actions, demo.goal, atoms, values, known, demo.alternatives)
    return one, answers


def goal_warnings(demos: Iterable[LabelledDemo]) -> list[str]:
    """Demonstrations whose labels say that the goal does not hold at the end, or held before (method 1.4)."""
    warnings = []
    for demo in demos:
        states = demo.abstract_states()
        missing = sorted(a for a in demo.reached if not holds([a], states[-1]))
        early = next((t for t, state in enumerate(states[:-1]) for goal in demo.goals if holds(goal, state)), None)
        if missing:
            warnings.append(f"{demo.name}: goal atom {missing[0]} does not hold in the last state")
        elif early is not None:
            warnings.append(f"{demo.name}: the goal holds already in state {early}")
    return warnings


class TooManyAtomsError(Pix2predError, ValueError):
    """Predicates have more atoms over the objects of a scene than are made; the message names the largest."""


def ground_atoms(predicates: Iterable[Predicate], objects: Sequence[Object]) -> tuple[Atom, ...]:
    """All type-consistent atoms over distinct objects (switch ``distinct_args`` of method 1.5 on), sorted.

    Raises ``TooManyAtomsError`` when there are more than ``MOST_ATOMS``.
    """
    predicates = tuple(predicates)
    refuse_too_many(predicates, objects, MOST_ATOMS)
    return tuple(sorted(Atom(p, args) for p in predicates for args in groundings(p.types, objects, distinct=True)))


def refuse_too_many(predicates: Sequence[Predicate], objects: Sequence[Object], most: int) -> None:
    """Raise ``TooManyAtomsError`` when ``predicates`` have more than ``most`` atoms over ``objects``; makes none."""
    counts = {p: count_groundings(p.types, objects, distinct=True) for p in predicates}
    total = sum(counts.values())
    if total > most:
        largest = max(predicates, key=lambda p: counts[p])
        raise TooManyAtomsError(
            f"{largest.signature} has {counts[largest]:,} of {total:,} atoms over {len(objects)} objects; more than "
            f"{most:,} are not labelled. Leave out objects or the predicate, or raise flow.max_atoms"
        )
