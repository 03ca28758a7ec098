"""Grounding: from operators over variables, objects and a goal to a task on bits."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pix2pred.planning.instances import Fact, GroundingBudgetError, Instances, Schema, all_apart
from pix2pred.planning.strips import Strips
from pix2pred.structs import AbstractState, Atom, LiftedAtom, Object, Operator, Predicate, Type, Variable

__all__ = ["DEFAULT_BUDGET", "GroundTask", "GroundingBudgetError", "ground"]

DEFAULT_BUDGET = 200_000
"""Ground operators of a task."""

MAX_MEGABYTES = 1_000
"""What the bits of a task's operators may take; a task of 100,000 facts and 20,000 operators takes about as much."""


@dataclass(frozen=True, slots=True)
class GroundTask:
    """A task on bits with the meaning of its bits: ``atoms[i]`` is bit i, ``instances[k]`` is operator k.

    ``goal_reachable`` is False when some goal atom cannot be reached even without deletes.
    """

    strips: Strips
    atoms: tuple[Atom, ...]
    instances: tuple[tuple[Operator, tuple[Object, ...]], ...]
    goal_reachable: bool


def ground(
    operators: Sequence[Operator],
    objects: Iterable[Object],
    initial: AbstractState,
    goal: Iterable[Atom],
    *,
    distinct: bool = True,
    budget: int = DEFAULT_BUDGET,
) -> GroundTask:
    """Ground ``operators`` over ``objects``. ``distinct``: parameters stand for distinct objects (law 4 of 1.6).

    Raises ``ValueError`` for atoms over other objects, and ``GroundingBudgetError`` when more than ``budget`` instances
    are reachable.
    """
    things = sorted(objects)
    object_ids = {o: i for i, o in enumerate(things)}
    predicate_ids: dict[Predicate, int] = {}

    def number(atom: Atom) -> Fact:
        strangers = [o.name for o in atom.objects if o not in object_ids]
        if strangers:
            raise ValueError(f"{atom} mentions {strangers[0]}, which is not among the objects of the task")
        p = predicate_ids.setdefault(atom.predicate, len(predicate_ids))
        return (p, *(object_ids[o] for o in atom.objects))

    numbered = _NumberedOperators(operators, things, predicate_ids, distinct=distinct)
    initial_facts = [number(a) for a in sorted(initial)]
    goal_facts = [number(a) for a in sorted(goal)]
    reached = Instances(numbered.schemas, initial_facts, budget)
    return _task(numbered, things, list(predicate_ids), reached, initial_facts, goal_facts)


class _NumberedOperators:
    """Operators with predicates, parameters and objects as numbers."""

    def __init__(
        self,
        operators: Sequence[Operator],
        objects: Sequence[Object],
        predicate_ids: dict[Predicate, int],
        *,
        distinct: bool,
    ) -> None:
        by_type: dict[Type, frozenset[int]] = {}
        for v in (v for operator in operators for v in operator.parameters):
            if v.type not in by_type:
                by_type[v.type] = frozenset(i for i, o in enumerate(objects) if o.type.is_a(v.type))
        self.operators = operators
        self.schemas: list[Schema] = []
        self.delete: list[tuple[Fact, ...]] = []
        for operator in operators:
            position = {v: i for i, v in enumerate(operator.parameters)}

            def numbered(atoms: Iterable[LiftedAtom], position: dict[Variable, int] = position) -> tuple[Fact, ...]:
                return tuple(
                    (predicate_ids.setdefault(a.predicate, len(predicate_ids)), *(position[v] for v in a.variables))
                    for a in sorted(atoms)
                )

            apart = all_apart(len(position)) if distinct else [()] * len(position)
            allowed = [by_type[v.type] for v in operator.parameters]
            pre, add = numbered(operator.preconditions), numbered(operator.add)
            self.schemas.append(Schema(allowed, pre, add, apart, operator.name))
            self.delete.append(numbered(operator.delete))


def _task(
    numbered: _NumberedOperators,
    objects: Sequence[Object],
    predicates: Sequence[Predicate],
    reached: Instances,
    initial: list[Fact],
    goal: list[Fact],
) -> GroundTask:
    """Number facts and operators independently of the order in which they were found."""
    atoms = {Atom(predicates[f[0]], tuple(objects[i] for i in f[1:])): f for f in reached.facts}
    ordered = sorted(atoms)
    index = {atoms[a]: i for i, a in enumerate(ordered)}
    instances = sorted(reached.found)
    check_size(len(ordered), len(instances))

    def mask(lifted: tuple[Fact, ...], binding: tuple[int, ...]) -> int:
        result = 0
        for effect in lifted:
            i = index.get((effect[0], *(binding[v] for v in effect[1:])))
            if i is not None:
                result |= 1 << i
        return result

    schemas = numbered.schemas
    strips = Strips(
        facts=len(ordered),
        pre=tuple(mask(schemas[s].pre, b) for s, b in instances),
        add=tuple(mask(schemas[s].add, b) for s, b in instances),
        delete=tuple(mask(numbered.delete[s], b) for s, b in instances),
        initial=bits_of(index[f] for f in initial),
        goal=bits_of(index[f] for f in goal if f in index),
        atoms=tuple(sorted(index, key=index.__getitem__)),
        kinds=tuple(o.type for o in objects),
    )
    return GroundTask(
        strips,
        tuple(ordered),
        tuple((numbered.operators[s], tuple(objects[i] for i in b)) for s, b in instances),
        all(f in index for f in goal),
    )


def check_size(facts: int, operators: int) -> None:
    """Raise ``GroundingBudgetError`` when the bits of so many operators over so many facts would fill the memory."""
    megabytes = 3 * operators * facts // 8 // 2**20
    if megabytes > MAX_MEGABYTES:
        raise GroundingBudgetError(
            f"{operators} ground operators over {facts} facts would take {megabytes} MB; {MAX_MEGABYTES} MB are allowed"
        )


def bits_of(positions: Iterable[int]) -> int:
    """The mask with the bits at ``positions``. Linear in the number of positions and in the highest one."""
    places = list(positions)
    taken = bytearray(max(places, default=0) // 8 + 1)
    for i in places:
        taken[i >> 3] |= 1 << (i & 7)
    return int.from_bytes(taken, "little")
