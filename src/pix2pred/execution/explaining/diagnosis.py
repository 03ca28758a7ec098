"""Telling wrong labels from a wrong model, after the fact (method 8.4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from pix2pred.predicates import Abstraction, StateLabeller, ground_atoms
from pix2pred.structs import AbstractState, Atom, FromVLM, Predicate, Task, WorldModel
from pix2pred.structs.goals.opposites import contrary

TruthOf = Callable[[Atom], bool | None]
"""The true value of a visual atom in the environment's present state; None for words without a ground truth."""


@dataclass(frozen=True, slots=True)
class LabelCheck:
    """The visual atoms of one state against the truth.

    ``known`` counts those whose truth is known, ``unknown`` the others; ``wrong`` holds the true values of those that
    were labelled wrongly.
    """

    known: int
    unknown: int
    wrong: Mapping[Atom, bool]


def visual(predicates: Sequence[Predicate]) -> list[Predicate]:
    """Those of ``predicates`` that are read from pictures."""
    return [p for p in predicates if isinstance(p.source, FromVLM)]


def check_labels(truth: TruthOf | None, seen: AbstractState, task: Task, model: WorldModel) -> LabelCheck:
    """Compares the visual atoms of ``seen`` with the truth of the state the environment is in."""
    known, unknown, wrong = 0, 0, dict[Atom, bool]()
    for atom in ground_atoms(visual(model.predicates), task.objects):
        value = truth(atom) if truth else None
        if value is None:
            unknown += 1
            continue
        known += 1
        if value != (atom in seen):
            wrong[atom] = value
    return LabelCheck(known, unknown, wrong)


def correct_labels(
    seen: AbstractState, errors: Mapping[Atom, bool], denied: frozenset[Predicate] = frozenset()
) -> AbstractState:
    """``seen`` with the wrong labels put right, and with them the opposites of the predicates ``denied``."""
    true = {atom for atom, value in errors.items() if value}
    opposites = {contrary(atom) for atom in errors.keys() - true if atom.predicate in denied}
    return frozenset((seen - errors.keys() - {contrary(atom) for atom in true}) | true | opposites)


def given_atoms(model: WorldModel, labeller: StateLabeller, task: Task) -> AbstractState:
    """The atoms of the task's initial state that hold and that no model is asked about."""
    asked = visual(model.predicates)
    others = [p for p in model.predicates if p not in asked]
    return Abstraction(task.objects, others, labeller).start(task.initial)
