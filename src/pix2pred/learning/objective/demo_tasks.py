"""Demonstrations as small planning tasks: grounding learned operators and simplifying (method 6.5, items 1 and 5).

Operators with few parameters are grounded once per set of objects, over all of them, and shared by all candidate sets.
Wrong labels can give operators of eight parameters and more; then only reachable instances are made (method 6.5,
item 8).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import prod

from pix2pred.learning.operators.transition_class import Lifted, OperatorSchema, to_operator
from pix2pred.learning.transitions import IndexedDemo, IndexedTable, ObjectIds
from pix2pred.planning import Strips, ground
from pix2pred.structs import Atom, Type

GroundBits = tuple[int, int, int]
"""Preconditions, add effects and delete effects of a ground operator, as bits of a scene's facts."""


MAX_INSTANCES = 20_000
"""Operators with more instances over a scene's objects are grounded by reachability."""


@dataclass(frozen=True, slots=True)
class _Grounding:
    """The instances of a schema in a scene, with and without their bindings."""

    bindings: tuple[ObjectIds, ...]
    bits: tuple[GroundBits, ...]


class SharedGroundings:
    """A set of objects shared by demonstrations, with one numbering of their facts and remembered groundings."""

    def __init__(self, data: IndexedTable, objects: ObjectIds) -> None:
        self._data = data
        self._objects = objects
        self._of_type: dict[str, list[int]] = {}
        self._bit: dict[tuple[int, ObjectIds], int] = {}
        self._effects: dict[int, tuple[object, _Grounding]] = {}
        self._complete: dict[tuple[int, tuple[Lifted, ...]], tuple[GroundBits, ...]] = {}

    def bit(self, predicate: int, objects: ObjectIds) -> int:
        """The bit of a fact; new facts are numbered as they come."""
        key = (predicate, objects)
        if key not in self._bit:
            self._bit[key] = 1 << len(self._bit)
        return self._bit[key]

    def mask(self, atoms: Iterable[tuple[int, ObjectIds]]) -> int:
        """The facts of ``atoms`` as bits."""
        result = 0
        for predicate, objects in atoms:
            result |= self.bit(predicate, objects)
        return result

    def instances(self, schema: OperatorSchema) -> int:
        """An upper bound on how many instances ``ground`` gives."""
        return prod([len(self._domain(t)) for t in schema.cls.types])

    def ground(self, schema: OperatorSchema) -> tuple[GroundBits, ...]:
        """All instances of ``schema`` over distinct objects of the scene."""
        key = (id(schema.cls), schema.pre)
        if key not in self._complete:
            base = self._ground_effects(schema)
            self._complete[key] = tuple(
                (self._lifted(schema.pre, binding), add, delete)
                for binding, (_, add, delete) in zip(base.bindings, base.bits, strict=True)
            )
        return self._complete[key]

    def _ground_effects(self, schema: OperatorSchema) -> _Grounding:
        cls = schema.cls
        if id(cls) not in self._effects:
            bindings = tuple(self._bindings(schema))
            bits = tuple((0, self._lifted(cls.add, b), self._lifted(cls.delete, b)) for b in bindings)
            self._effects[id(cls)] = (cls, _Grounding(bindings, bits))  # keeps the class alive, so its id stays its own
        return self._effects[id(cls)][1]

    def _bindings(self, schema: OperatorSchema) -> Iterator[ObjectIds]:
        yield from _injections([self._domain(t) for t in schema.cls.types], ())

    def _domain(self, t: Type) -> list[int]:
        if t.name not in self._of_type:
            self._of_type[t.name] = [o for o in self._objects if self._data.objects[o].type.is_a(t)]
        return self._of_type[t.name]

    def _lifted(self, atoms: Sequence[Lifted], binding: ObjectIds) -> int:
        result = 0
        for predicate, variables in atoms:
            result |= self.bit(predicate, tuple(binding[v] for v in variables))
        return result


def _injections(domains: Sequence[Sequence[int]], chosen: ObjectIds) -> Iterator[ObjectIds]:
    """Every choice of one object per domain without repeats, in order."""
    if len(chosen) == len(domains):
        yield chosen
        return
    for o in domains[len(chosen)]:
        if o not in chosen:
            yield from _injections(domains, (*chosen, o))


def relevant_task(operators: Sequence[GroundBits], initial: int, goal: int) -> Strips | None:
    """The reachable part of a task without the facts that cannot matter; ``None`` if the goal is unreachable.

    Drops operators with preconditions that even a delete-free execution never reaches, facts that hold throughout,
    and facts in no precondition or goal; renumbers what is left. No plan is gained or lost.
    """
    reached = initial
    waiting: Sequence[GroundBits] = operators
    used: list[GroundBits] = []
    grown = True
    while grown:
        still = []
        missing = ~reached
        for operator in waiting:
            if operator[0] & missing:
                still.append(operator)
            else:
                used.append(operator)
                reached |= operator[1]
        waiting = still
        grown = bool(reached & missing)
    if goal & ~reached:
        return None
    wanted = goal
    deleted = 0
    for pre, _, delete in used:
        wanted |= pre
        deleted |= delete
    relevant = wanted & ~(initial & ~deleted)
    compact = _Compactor(relevant)
    projected = sorted((compact(pre), compact(add), compact(delete)) for pre, add, delete in used)
    return Strips(
        compact.size,
        tuple(o[0] for o in projected),
        tuple(o[1] for o in projected),
        tuple(o[2] for o in projected),
        compact(initial),
        compact(goal),
    )


class _Compactor:
    """Projects bit sets onto the set bits of a mask, renumbered from zero."""

    def __init__(self, mask: int) -> None:
        self._mask = mask
        self._positions: dict[int, int] = {}
        while mask:
            low = mask & -mask
            self._positions[low] = 1 << len(self._positions)
            mask ^= low
        self._known: dict[int, int] = {0: 0}

    @property
    def size(self) -> int:
        return len(self._positions)

    def __call__(self, value: int) -> int:
        value &= self._mask
        if value not in self._known:
            rest, result = value, 0
            while rest:
                low = rest & -rest
                result |= self._positions[low]
                rest ^= low
            self._known[value] = result
        return self._known[value]


def ground_task(
    data: IndexedTable, scene: SharedGroundings, d: int, operators: Sequence[OperatorSchema], predicates: Iterable[int]
) -> Strips | None:
    """The relevant part of demonstration ``d`` as a planning task over ``predicates``.

    Raises ``GroundingBudgetError`` when too many instances are reachable.
    """
    if all(scene.instances(schema) <= MAX_INSTANCES for schema in operators):
        instances = [bits for schema in operators for bits in scene.ground(schema)]
        return relevant_task(instances, *initial_and_goal(data, scene, d, predicates))
    demo = data.demos[d]

    def atom(predicate: int, objects: ObjectIds) -> Atom:
        return Atom(data.predicates[predicate], tuple(data.objects[o] for o in objects))

    initial = frozenset(atom(p, objects) for p in predicates for objects in data.extension(d, 0, p))
    named = [to_operator(data, schema) for schema in operators]
    objects = [data.objects[o] for o in demo.objects]
    task = ground(named, objects, initial, [atom(*fact) for fact in demo.goal])
    reachable = zip(task.strips.pre, task.strips.add, task.strips.delete, strict=True)
    return relevant_task(tuple(reachable), task.strips.initial, task.strips.goal) if task.goal_reachable else None


def initial_and_goal(
    data: IndexedTable, scene: SharedGroundings, index: int, predicates: Iterable[int]
) -> tuple[int, int]:
    """The initial facts over ``predicates`` and the goal facts of a demonstration, as bits."""
    demo: IndexedDemo = data.demos[index]
    initial = scene.mask((p, objects) for p in sorted(predicates) for objects in sorted(data.extension(index, 0, p)))
    return initial, scene.mask(demo.goal)
