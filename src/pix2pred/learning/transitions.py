"""Demonstrations as numbers: what operator learning and the objective work on.

Objects, predicates and skills become indices. An atom is (predicate, objects); the objects of all demonstrations share
one numbering in sorted order, so comparing indices compares names.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pix2pred.structs import (
    Action,
    Atom,
    Candidate,
    Label,
    LabelledDemo,
    Object,
    Predicate,
    Skill,
    TruthTable,
    Type,
    groundings,
    unknown_as_false,
)
from pix2pred.structs.goals.opposites import contrary, is_denial
from pix2pred.structs.skills import FAILED

ObjectIds = tuple[int, ...]
Extension = frozenset[ObjectIds]
"""The argument tuples of which a predicate is true in one state."""

NOTHING: Extension = frozenset()


@dataclass(frozen=True, slots=True)
class Transition:
    """One step of a demonstration: between state ``step`` and ``step + 1`` of demonstration ``demo``."""

    demo: int
    step: int
    skill: int
    args: ObjectIds


@dataclass(frozen=True, slots=True)
class IndexedDemo:
    """A demonstration's objects, goal atoms and length in states, and how many of its steps failed.

    ``denied`` are the atoms of which its goal says that they must not hold.
    """

    objects: ObjectIds
    goal: tuple[tuple[int, ObjectIds], ...]
    states: int
    failed: int = 0
    denied: tuple[tuple[int, ObjectIds], ...] = ()


class IndexedTable:
    """The truth table in numbers. Predicates ``0..initial-1`` are the initial ones, the rest the candidates."""

    def __init__(self, table: TruthTable) -> None:
        self.candidates: tuple[Candidate, ...] = table.candidates()
        self.predicates: tuple[Predicate, ...] = (*sorted(table.initial), *(c.predicate for c in self.candidates))
        self.initial = len(table.initial)
        self.objects: tuple[Object, ...] = tuple(sorted({o for demo in table.demos for o in demo.objects}))
        actions = [action for demo in table.demos for action in demo.actions]
        self.skills: tuple[Skill, ...] = tuple(sorted({_skill(action) for action in actions}))
        failed = {_skill(action) for action in actions if action.failed}
        self.failed = frozenset(i for i, skill in enumerate(self.skills) if skill in failed)
        """Skills whose transitions are failures: no operator is learned of them."""
        self._object_ids = {o: i for i, o in enumerate(self.objects)}
        self._predicate_ids = {p: i for i, p in enumerate(self.predicates)}
        self._extensions = [self._read_states(demo, unknown_as_false(demo.values)) for demo in table.demos]
        self._unknown = [self._read_states(demo, demo.values == Label.UNKNOWN) for demo in table.demos]
        self.demos = tuple(self._read_demo(demo) for demo in table.demos)
        self.transitions = tuple(self._read_transitions(table.demos))
        self._effects = [self._changes(p) for p in range(len(self.predicates))]
        self._held: dict[int, dict[ObjectIds, int]] = {}
        self._declared_types = False

    def with_declared_types(self) -> IndexedTable:
        """The same, the arguments of skills having the types that these declare, where effects allow it."""
        new = copy(self)
        new._declared_types = True
        return new

    def argument_types(self, transition: int, about: Iterable[tuple[int, ObjectIds]]) -> tuple[Type, ...]:
        """The types of variables for a skill's arguments in a transition whose effects are ``about`` these atoms.

        They are the types of the objects; with declared types the most general ones, up to those that the skill
        declares, of which the atoms can be.
        """
        tr = self.transitions[transition]
        if not self._declared_types or len(set(tr.args)) < len(tr.args):
            return self.types(tr.args)
        wanted: dict[int, list[Type]] = {o: [] for o in tr.args}
        for predicate, objects in about:
            for o, t in zip(objects, self.predicates[predicate].types, strict=True):
                wanted.get(o, []).append(t)
        declared = self.skills[tr.skill].types
        return tuple(
            _most_general(self.objects[o].type, most, wanted[o]) for o, most in zip(tr.args, declared, strict=True)
        )

    def cost(self, predicate: int) -> float:
        """What choosing a candidate costs in the objective."""
        return self.candidates[predicate - self.initial].cost

    def types(self, objects: ObjectIds) -> tuple[Type, ...]:
        """The types of ``objects``."""
        return tuple(self.objects[o].type for o in objects)

    def fits(self, types: Sequence[Type], predicate: int, variables: Sequence[int]) -> bool:
        """Whether ``variables`` of these ``types`` may be arguments of ``predicate``."""
        return all(types[v].is_a(t) for v, t in zip(variables, self.predicates[predicate].types, strict=True))

    def extension(self, demo: int, state: int, predicate: int) -> Extension:
        """The argument tuples of which ``predicate`` is true in a state."""
        return self._extensions[demo][state].get(predicate, NOTHING)

    def unknown(self, demo: int, state: int, predicate: int) -> Extension:
        """The argument tuples for which nobody knows whether ``predicate`` is true in a state."""
        return self._unknown[demo][state].get(predicate, NOTHING)

    def relabelled(self, extensions: Mapping[int, Sequence[Sequence[Extension]]]) -> IndexedTable:
        """The same demonstrations, the predicates of ``extensions`` with other values (by demonstration and state)."""
        new = copy(self)
        new._extensions = [
            [state | {p: values[d][s] for p, values in extensions.items()} for s, state in enumerate(states)]
            for d, states in enumerate(self._extensions)
        ]
        new._effects = [new._changes(p) if p in extensions else effects for p, effects in enumerate(self._effects)]
        new._held = {}
        return new

    def with_goals_reached(self, predicates: Collection[int]) -> IndexedTable:
        """The same, with the goals of demonstrations true in their last states as far as they are about ``predicates``:
        a demonstration reaches its goal by definition (method 1.4), whatever its last labels say."""
        reached: dict[int, list[list[Extension]]] = {}
        for p in sorted({p for demo in self.demos for p, _ in (*demo.goal, *demo.denied) if p in predicates}):
            values = [[self.extension(d, s, p) for s in range(demo.states)] for d, demo in enumerate(self.demos)]
            for d, demo in enumerate(self.demos):
                values[d][-1] = (values[d][-1] | _about(p, demo.goal)) - _about(p, demo.denied)
            reached[p] = values
        new = self.relabelled(reached)
        new._unknown = [
            [*states[:-1], {p: args - _about(p, demo.goal) - _about(p, demo.denied) for p, args in states[-1].items()}]
            for states, demo in zip(self._unknown, self.demos, strict=True)
        ]
        return new

    def before(self, transition: int, predicate: int) -> Extension:
        """The extension of ``predicate`` in the state before a transition."""
        tr = self.transitions[transition]
        return self._extensions[tr.demo][tr.step].get(predicate, NOTHING)

    def held_before(self, predicate: int) -> dict[ObjectIds, int]:
        """The argument tuples of which ``predicate`` is ever true, with the transitions before which it is, as bits."""
        if predicate not in self._held:
            held: dict[ObjectIds, int] = {}
            first = 0
            for d, demo in enumerate(self.demos):
                end = first + demo.states - 1
                since = dict.fromkeys(self.extension(d, 0, predicate), first)
                for t in range(first, end):
                    added, deleted = self.effects(predicate, t)
                    for args in deleted:
                        held[args] = held.get(args, 0) | (2 << t) - (1 << since.pop(args))
                    for args in added:
                        since[args] = t + 1
                for args, t in since.items():
                    held[args] = held.get(args, 0) | (1 << end) - (1 << t)
                first = end
            self._held[predicate] = held
        return self._held[predicate]

    def effects(self, predicate: int, transition: int) -> tuple[Extension, Extension]:
        """(added, deleted) argument tuples of ``predicate`` over a transition."""
        return self._effects[predicate].get(transition, (NOTHING, NOTHING))

    def changing(self, predicate: int) -> frozenset[int]:
        """The transitions over which ``predicate`` changes."""
        return frozenset(self._effects[predicate])

    def demos_divided(self, predicate: int) -> int:
        """In how many demonstrations ``predicate`` is at first true of some of the objects it may be about, not all."""
        types = self.predicates[predicate].types
        count = 0
        for d, demo in enumerate(self.demos):
            held = self.extension(d, 0, predicate)
            objects = [self.objects[o] for o in demo.objects]
            count += bool(held) and any(
                tuple(self._object_ids[o] for o in args) not in held
                for args in groundings(types, objects, distinct=True)
            )
        return count

    def column(self, predicate: int) -> tuple[object, ...]:
        """All values of a predicate: two candidates with equal columns are interchangeable."""
        states = (self.extension(d, s, predicate) for d, demo in enumerate(self._extensions) for s in range(len(demo)))
        return (self.predicates[predicate].types, *states)

    def _read_states(self, demo: LabelledDemo, marked: NDArray[np.bool_]) -> list[dict[int, Extension]]:
        """Per state and predicate, the argument tuples that are ``marked``."""
        known = [(atom.predicate in self._predicate_ids) for atom in demo.atoms]
        places = [
            (self._predicate_ids[atom.predicate], tuple([self._object_ids[o] for o in atom.objects]))
            if is_known
            else None
            for atom, is_known in zip(demo.atoms, known, strict=True)
        ]
        states: list[dict[int, list[ObjectIds]]] = [{} for _ in range(len(marked))]
        for row, column in np.argwhere(marked).tolist():
            if (place := places[column]) is not None:
                states[row].setdefault(place[0], []).append(place[1])
        unique: dict[Extension, Extension] = {}  # most extensions are equal to many others: keep one of each

        def extension(found: list[ObjectIds]) -> Extension:
            made = frozenset(found)
            return unique.setdefault(made, made)

        return [{p: extension(found) for p, found in state.items()} for state in states]

    def _changes(self, predicate: int) -> dict[int, tuple[Extension, Extension]]:
        """By transition, where there are any, the argument tuples that a predicate gains and loses."""
        found: dict[int, tuple[Extension, Extension]] = {}
        t = 0
        for states in self._extensions:
            for before, after in pairwise([state.get(predicate, NOTHING) for state in states]):
                if before is not after and before != after:
                    found[t] = (after - before, before - after)
                t += 1
        return found

    def _read_demo(self, demo: LabelledDemo) -> IndexedDemo:
        objects = tuple(sorted(self._object_ids[o] for o in demo.objects))
        reached = demo.reached

        def numbered(atoms: Iterable[Atom]) -> tuple[tuple[int, ObjectIds], ...]:
            places = ((a.predicate, a.objects) for a in atoms)
            return tuple([(self._predicate_ids[p], tuple([self._object_ids[o] for o in args])) for p, args in places])

        goal = numbered(a for a in reached if not is_denial(a))
        denied = numbered(contrary(a) for a in reached if is_denial(a))
        return IndexedDemo(objects, goal, len(demo.actions) + 1, sum(action.failed for action in demo.actions), denied)

    def _read_transitions(self, demos: Sequence[LabelledDemo]) -> list[Transition]:
        skill_ids = {s: i for i, s in enumerate(self.skills)}
        return [
            Transition(d, step, skill_ids[_skill(action)], tuple(self._object_ids[o] for o in action.objects))
            for d, demo in enumerate(demos)
            for step, action in enumerate(demo.actions)
        ]


def _about(predicate: int, atoms: Iterable[tuple[int, ObjectIds]]) -> Extension:
    """The argument tuples of ``predicate`` among ``atoms``."""
    return frozenset(args for p, args in atoms if p == predicate)


def _skill(action: Action) -> Skill:
    """The skill of an action; failures of a skill are told apart from it as another."""
    skill = action.skill
    return replace(skill, name=f"{skill.name} ({FAILED})") if action.failed else skill


def _most_general(own: Type, most: Type, wanted: Sequence[Type]) -> Type:
    """The type furthest above ``own``, up to ``most``, that is still each of the types ``wanted``."""
    found = own
    while found.name != most.name and found.parent is not None and all(found.parent.is_a(t) for t in wanted):
        found = found.parent
    return found
