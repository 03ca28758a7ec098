"""Labelled demonstrations of a domain with hidden predicates, in the traces format, and the problems to test on."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from random import Random
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning import dump_traces
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem
from pix2pred.structs import (
    AbstractState,
    Action,
    Atom,
    Candidate,
    Label,
    LabelledDemo,
    LiftedAtom,
    Operator,
    Predicate,
    TruthTable,
    Vocabulary,
)
from symbolic.distractors import Column, Moment, candidates
from symbolic.problems import CATALOGUE, SolvedProblem, demonstrations, load_domain, tests

CANDIDATES = 30


@dataclass(frozen=True)
class Workload:
    """What a learner gets (``table``, ``vocabulary``, or both as ``document``) and what it is judged by."""

    domain: PddlDomain
    vocabulary: Vocabulary
    table: TruthTable
    columns: tuple[Column, ...]
    hidden: tuple[str, ...]
    tests: tuple[PddlProblem, ...]

    @property
    def document(self) -> dict[str, Any]:
        """The traces file."""
        document: dict[str, Any] = json.loads(dump_traces(self.vocabulary, self.table, {}))
        return document

    def told(self) -> TruthTable:
        """The table of somebody who knows which candidates are the hidden predicates."""
        pool = tuple(c for c in self.table.pool if c.predicate.name in self.hidden)
        known = (*self.table.initial, *(c.predicate for c in pool))
        return TruthTable(self.table.initial, pool, tuple(d.restricted(known) for d in self.table.demos))

    def true_operators(self, *, known: bool = True) -> tuple[Operator, ...]:
        """The true domain, the hidden predicates under their candidates' names, or (not ``known``) left out."""
        candidate = {c.meaning: c.predicate for c in self.columns if c.predicate.name in self.hidden}

        def seen(atoms: Iterable[LiftedAtom]) -> frozenset[LiftedAtom]:
            kept = [a for a in atoms if known or a.predicate.name not in candidate]
            return frozenset(LiftedAtom(candidate.get(a.predicate.name, a.predicate), a.variables) for a in kept)

        return tuple(
            replace(op, preconditions=seen(op.preconditions), add=seen(op.add), delete=seen(op.delete))
            for op in self.domain.operators
        )

    def initial_state(self, problem: PddlProblem, selected: Sequence[str]) -> AbstractState:
        """The true start of a test problem over given and selected predicates."""
        now = Moment(problem.name, problem.objects, problem.initial, frozenset(), ())
        given = {a for a in problem.initial if a.predicate in self.table.initial}
        chosen = [c for c in self.columns if c.predicate.name in selected]
        return frozenset(given | {Atom(c.predicate, args) for c in chosen for args in c.truth(now)})


def make_traces(
    domain: str, seed: int, flip_rate: float, unknown_rate: float = 0.0, sticky: bool = False, skill_args: str = "all"
) -> Workload:
    """Twelve optimal demonstrations with one or two hidden predicates among thirty candidates.

    Only candidates are mislabelled: each ground atom of each state with ``flip_rate``, independently, or (``sticky``)
    anew only when an action touches one of its objects. ``skill_args``: see ``load_domain``. Problems, candidates and
    the choice of what is hidden depend on domain and seed alone.
    """
    true = load_domain(domain, skill_args)
    by_name = {p.name: p for p in true.predicates}
    hidden = [by_name[name] for name in Random(f"{domain}/{seed}/hidden").choice(CATALOGUE[domain][1])]
    columns = candidates(true, hidden, f"{domain}/{seed}", CANDIDATES)
    given = tuple(p for p in true.predicates if p not in hidden)
    pool = tuple(Candidate(c.predicate, float(c.predicate.arity)) for c in columns)
    noise = np.random.default_rng([seed, *domain.encode()])
    labeller = _Labeller(true, given, columns, noise, flip_rate, unknown_rate, sticky)
    table = TruthTable(given, pool, tuple(labeller.label(demo) for demo in demonstrations(domain, seed)))
    skills = tuple(sorted({op.skill for op in true.operators}))
    names = tuple(c.predicate.name for c in columns if c.meaning in {p.name for p in hidden})
    problems = tuple(test.problem for test in tests(domain, seed))
    return Workload(true, Vocabulary(domain, true.types, skills, given), table, columns, names, problems)


@dataclass(frozen=True)
class _Labeller:
    domain: PddlDomain
    given: tuple[Predicate, ...]
    columns: tuple[Column, ...]
    noise: np.random.Generator
    flip_rate: float
    unknown_rate: float
    sticky: bool

    def label(self, demo: SolvedProblem) -> LabelledDemo:
        """The demonstration with exact given atoms and mislabelled candidates."""
        problem = demo.problem
        given = sorted({a for state in demo.states for a in state if a.predicate in self.given})
        exact = np.array([[a in state for a in given] for state in demo.states], dtype=np.int8)
        atoms, truth = self._truth(demo)
        values = np.where(self._errors(demo, atoms), 1 - truth, truth).astype(np.int8)
        values[self.noise.random(values.shape) < self.unknown_rate] = Label.UNKNOWN
        order = sorted(range(len(given) + len(atoms)), key=[*given, *atoms].__getitem__)
        everything = tuple([*given, *atoms][i] for i in order)
        labels = np.concatenate([exact, values], axis=1)[:, order]
        operators = {op.name: op for op in self.domain.operators}
        bound = [operators[step.operator.name].ground(step.objects) for step in demo.plan]
        actions = tuple(Action(step.operator.skill, step.skill_objects) for step in bound)
        return LabelledDemo(problem.name, problem.objects, actions, problem.goal, everything, labels)

    def _truth(self, demo: SolvedProblem) -> tuple[list[Atom], NDArray[np.int8]]:
        """All ground candidate atoms and their true values, shape (states, atoms)."""
        states, objects = demo.states, demo.problem.objects
        moments = [
            Moment(demo.problem.name, objects, state, states[max(0, t - 1)], demo.plan[:t])
            for t, state in enumerate(states)
        ]
        atoms: list[Atom] = []
        values = []
        for column in self.columns:
            args = moments[0].all(column.predicate.types)
            held = [column.truth(now) for now in moments]
            atoms += [Atom(column.predicate, a) for a in args]
            values.append(np.array([[a in h for a in args] for h in held], dtype=np.int8).reshape(len(states), -1))
        return atoms, np.concatenate(values, axis=1)

    def _errors(self, demo: SolvedProblem, atoms: Sequence[Atom]) -> NDArray[np.bool_]:
        errors = self.noise.random((len(demo.states), len(atoms))) < self.flip_rate
        if self.sticky:
            for t, step in enumerate(demo.plan, start=1):
                touched = np.array([not a.objects or not set(a.objects).isdisjoint(step.objects) for a in atoms])
                errors[t] = np.where(touched, errors[t], errors[t - 1])
        return errors
