"""Demonstrations as small planning tasks: grounding learned operators and simplifying (method 6.5, items 1 and 5).

Names do not matter for J, so demonstrations with as many objects of every type share one numbering of objects, facts
and ground operators. Within a type objects are numbered in the order in which they are acted on, so that demonstrations
that do the same with other objects become equal tasks. Operators with few parameters are grounded once per numbering
and shared by all candidate sets; wrong labels can give operators of eight parameters and more, of which only reachable
instances are made (method 6.5, item 8).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import prod

from pix2pred.learning.objective.relevant import GroundBits, relevant_task
from pix2pred.learning.operators.transition_class import Lifted, OperatorSchema, to_operator
from pix2pred.learning.transitions import IndexedTable, ObjectIds
from pix2pred.planning import Strips, ground
from pix2pred.structs import Atom, Type
from pix2pred.structs.goals.opposites import changing_denials, contrary, with_denials

MAX_INSTANCES = 20_000
"""Operators with more instances over a demonstration's objects are grounded by reachability."""


@dataclass(frozen=True, slots=True)
class _Grounding:
    """The instances of a schema, with and without their bindings."""

    bindings: tuple[ObjectIds, ...]
    bits: tuple[GroundBits, ...]


class SharedGroundings:
    """Objects of given types, numbered from 0, with one numbering of their facts and remembered groundings.

    Operators also change the opposites of the predicates ``denied`` (``structs.goals.opposites``); the opposite of the
    predicate with number p has the number ``~p``.
    """

    def __init__(self, types: Sequence[Type], denied: frozenset[int] = frozenset()) -> None:
        self.types = types
        self._denied = denied
        self.atoms: list[tuple[int, ...]] = []
        self._of_type: dict[Type, list[int]] = {}
        self._bit: dict[tuple[int, ObjectIds], int] = {}
        self._effects: dict[int, tuple[object, _Grounding]] = {}
        self._complete: dict[tuple[int, tuple[Lifted, ...]], tuple[tuple[GroundBits, ...], int]] = {}

    def bit(self, predicate: int, objects: ObjectIds) -> int:
        """The bit of a fact; new facts are numbered as they come."""
        key = (predicate, objects)
        found = self._bit.get(key)
        if found is None:
            found = self._bit[key] = 1 << len(self._bit)
            self.atoms.append((predicate, *objects))
        return found

    def instances(self, schema: OperatorSchema) -> int:
        """An upper bound on how many instances ``ground`` gives."""
        return prod([len(self._domain(t)) for t in schema.cls.types])

    def ground(self, schema: OperatorSchema) -> tuple[tuple[GroundBits, ...], int]:
        """All instances of ``schema`` over distinct objects, and all facts in their preconditions."""
        key = (id(schema.cls), schema.pre)
        if key not in self._complete:
            base = self._ground_effects(schema)
            found = tuple(
                (self._lifted(schema.pre, binding), add, delete)
                for binding, (_, add, delete) in zip(base.bindings, base.bits, strict=True)
            )
            wanted = 0
            for pre, _, _ in found:
                wanted |= pre
            self._complete[key] = found, wanted
        return self._complete[key]

    def _ground_effects(self, schema: OperatorSchema) -> _Grounding:
        cls = schema.cls
        if id(cls) not in self._effects:
            bindings = tuple(_injections([self._domain(t) for t in cls.types], ()))
            add, delete = (*cls.add, *self._opposites(cls.delete)), (*cls.delete, *self._opposites(cls.add))
            bits = tuple((0, self._lifted(add, b), self._lifted(delete, b)) for b in bindings)
            self._effects[id(cls)] = (cls, _Grounding(bindings, bits))  # keeps the class alive, so its id stays its own
        return self._effects[id(cls)][1]

    def _opposites(self, atoms: Sequence[Lifted]) -> tuple[Lifted, ...]:
        return tuple([(~predicate, variables) for predicate, variables in atoms if predicate in self._denied])

    def _domain(self, t: Type) -> list[int]:
        if t not in self._of_type:
            self._of_type[t] = [o for o, own in enumerate(self.types) if own.is_a(t)]
        return self._of_type[t]

    def _lifted(self, atoms: Sequence[Lifted], binding: ObjectIds) -> int:
        result = 0
        for predicate, variables in atoms:
            result |= self.bit(predicate, tuple([binding[v] for v in variables]))
        return result


def _injections(domains: Sequence[Sequence[int]], chosen: ObjectIds) -> Iterator[ObjectIds]:
    """Every choice of one object per domain without repeats, in order."""
    if len(chosen) == len(domains):
        yield chosen
        return
    for o in domains[len(chosen)]:
        if o not in chosen:
            yield from _injections(domains, (*chosen, o))


@dataclass(frozen=True, slots=True)
class _NumberedDemo:
    """A demonstration in the numbering of its ``groundings``; ``facts`` remembers by predicate what holds at first.

    ``absent`` are the opposites in ``goal`` that hold at first.
    """

    groundings: SharedGroundings
    numbers: dict[int, int]
    goal: int
    absent: int
    facts: dict[int, int]


class SetTasks:
    """The tasks of one predicate set: demonstrations in which it says the same at first share one."""

    def __init__(self, operators: Sequence[OperatorSchema], predicates: Sequence[int]) -> None:
        self.operators = operators
        self.predicates = predicates
        self.grounded: dict[int, tuple[list[GroundBits], int] | None] = {}
        self.known: dict[tuple[int, int, int], Strips | None] = {}


class DemoTasks:
    """Makes the planning tasks of one data set's demonstrations."""

    def __init__(self, data: IndexedTable) -> None:
        self._data = data
        self._denied = frozenset(p for demo in data.demos for p, _ in demo.denied)
        groundings: dict[tuple[Type, ...], SharedGroundings] = {}
        self._demos = [self._number(d, groundings) for d in range(len(data.demos))]

    def task(self, of_set: SetTasks, d: int) -> Strips | None:
        """The relevant part of demonstration ``d`` over the predicates of a set; ``None`` if its goal is unreachable.

        Raises ``GroundingBudgetError`` when too many instances are reachable.
        """
        demo = self._demos[d]
        shared = id(demo.groundings)
        if shared not in of_set.grounded:
            of_set.grounded[shared] = _grounded(demo.groundings, of_set.operators)
        grounded = of_set.grounded[shared]
        if grounded is None:
            return self._reachable_task(of_set, d)
        instances, wanted = grounded
        initial = demo.absent
        for p in of_set.predicates:
            initial |= demo.facts[p] if p in demo.facts else self._facts(demo, d, p)
        key = (shared, initial & (wanted | demo.goal), demo.goal)
        if key not in of_set.known:
            of_set.known[key] = relevant_task(
                instances, key[1], demo.goal, demo.groundings.atoms, demo.groundings.types
            )
        return of_set.known[key]

    def _number(self, d: int, groundings: dict[tuple[Type, ...], SharedGroundings]) -> _NumberedDemo:
        data = self._data
        demo = data.demos[d]
        acted = [o for tr in data.transitions if tr.demo == d for o in tr.args]
        first = {o: i for i, o in reversed(list(enumerate(acted)))}
        ordered = sorted(demo.objects, key=lambda o: (data.objects[o].type.name, first.get(o, len(acted)), o))
        types = data.types(tuple(ordered))
        shared = groundings.setdefault(types, SharedGroundings(types, self._denied))
        numbers = {o: i for i, o in enumerate(ordered)}
        goal = 0
        for predicate, objects in demo.goal:
            goal |= shared.bit(predicate, tuple([numbers[o] for o in objects]))
        absent = 0
        for predicate, objects in demo.denied:
            fact = shared.bit(~predicate, tuple([numbers[o] for o in objects]))
            goal |= fact
            absent |= 0 if objects in data.extension(d, 0, predicate) else fact
        return _NumberedDemo(shared, numbers, goal, absent, {})

    def _facts(self, demo: _NumberedDemo, d: int, predicate: int) -> int:
        """What holds of a predicate in the first state."""
        atoms = sorted(tuple([demo.numbers[o] for o in objects]) for objects in self._data.extension(d, 0, predicate))
        found = 0
        for objects in atoms:
            found |= demo.groundings.bit(predicate, objects)
        demo.facts[predicate] = found
        return found

    def _reachable_task(self, of_set: SetTasks, d: int) -> Strips | None:
        data, demo = self._data, self._data.demos[d]

        def atom(predicate: int, objects: ObjectIds) -> Atom:
            return Atom(data.predicates[predicate], tuple(data.objects[o] for o in objects))

        objects = [data.objects[o] for o in demo.objects]
        denied = frozenset(data.predicates[p] for p in self._denied)
        initial = frozenset(atom(p, objects) for p in of_set.predicates for objects in data.extension(d, 0, p))
        named = changing_denials([to_operator(data, schema) for schema in of_set.operators], denied)
        goal = [*(atom(*fact) for fact in demo.goal), *(contrary(atom(*fact)) for fact in demo.denied)]
        task = ground(named, objects, with_denials(initial, denied, objects), goal)
        reachable = zip(task.strips.pre, task.strips.add, task.strips.delete, strict=True)
        return relevant_task(tuple(reachable), task.strips.initial, task.strips.goal) if task.goal_reachable else None


def _grounded(groundings: SharedGroundings, operators: Iterable[OperatorSchema]) -> tuple[list[GroundBits], int] | None:
    """All instances of all operators, with the facts that are some precondition; ``None`` if one has too many."""
    instances: list[GroundBits] = []
    wanted = 0
    for schema in operators:
        if groundings.instances(schema) > MAX_INSTANCES:
            return None
    for schema in operators:
        found, preconditions = groundings.ground(schema)
        instances += found
        wanted |= preconditions
    return instances, wanted
