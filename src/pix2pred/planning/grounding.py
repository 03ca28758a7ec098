"""Grounding by semi-naive evaluation of the delete relaxation (delta grounding).

An operator is instantiated only with facts that are reachable when deletes are ignored. Every round joins one *new*
fact with facts already known, so each instance is found without ever enumerating all tuples of objects. The idea is
that of Datalog-based grounding (Helmert, "Concise finite-domain representations for PDDL planning tasks", 2009).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from pix2pred.planning.strips import Strips
from pix2pred.structs import AbstractState, Atom, LiftedAtom, Object, Operator, Predicate

Fact = tuple[int, ...]
"""Predicate number followed by object numbers."""

Binding = list[int]
"""Object number of each operator parameter; -1 while unbound."""

DEFAULT_BUDGET = 200_000


class GroundingBudgetError(RuntimeError):
    """The task has more ground operators than the budget allows."""


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
    return _Grounder(operators, objects, distinct=distinct, budget=budget).run(initial, goal)


class _Schema:
    """An operator with predicates and parameters as numbers."""

    def __init__(self, operator: Operator, predicate_ids: dict[Predicate, int], allowed: list[frozenset[int]]) -> None:
        self.operator = operator
        self.allowed = allowed
        position = {v: i for i, v in enumerate(operator.parameters)}

        def numbered(atoms: Iterable[LiftedAtom]) -> tuple[Fact, ...]:
            return tuple(
                (predicate_ids.setdefault(a.predicate, len(predicate_ids)), *(position[v] for v in a.variables))
                for a in sorted(atoms)
            )

        self.pre = numbered(operator.preconditions)
        self.add = numbered(operator.add)
        self.delete = numbered(operator.delete)
        self.join_orders = [self._join_order(i) for i in range(len(self.pre))]

    def _join_order(self, first: int) -> list[tuple[Fact, tuple[int, ...]]]:
        """The other preconditions, the most bound next, each with its argument positions bound by then."""
        bound = set(self.pre[first][1:])
        rest = [p for i, p in enumerate(self.pre) if i != first]
        order = []
        while rest:
            best = min(rest, key=lambda p: (len(set(p[1:]) - bound), rest.index(p)))
            rest.remove(best)
            order.append((best, tuple(i for i, v in enumerate(best[1:], start=1) if v in bound)))
            bound |= set(best[1:])
        return order


class _Grounder:
    def __init__(
        self, operators: Sequence[Operator], objects: Iterable[Object], *, distinct: bool, budget: int
    ) -> None:
        self.objects = sorted(objects)
        self.distinct = distinct
        self.budget = budget
        self.predicate_ids: dict[Predicate, int] = {}
        by_type: dict[object, frozenset[int]] = {}
        for operator in operators:
            for v in operator.parameters:
                if v.type not in by_type:
                    by_type[v.type] = frozenset(i for i, o in enumerate(self.objects) if o.type.is_a(v.type))
        self.schemas = [_Schema(op, self.predicate_ids, [by_type[v.type] for v in op.parameters]) for op in operators]
        self.facts: dict[Fact, int] = {}
        self.instances: dict[tuple[int, tuple[int, ...]], None] = {}
        self.patterns: dict[int, set[tuple[int, ...]]] = defaultdict(set)
        for schema in self.schemas:
            for order in schema.join_orders:
                for precondition, positions in order:
                    self.patterns[precondition[0]].add(positions)
        self.index: dict[tuple[int, tuple[int, ...], tuple[int, ...]], list[Fact]] = defaultdict(list)
        self.triggers: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for s, schema in enumerate(self.schemas):
            for i, precondition in enumerate(schema.pre):
                self.triggers[precondition[0]].append((s, i))

    def run(self, initial: AbstractState, goal: Iterable[Atom]) -> GroundTask:
        """Work off the queue of new facts."""
        object_ids = {o: i for i, o in enumerate(self.objects)}

        def number(atom: Atom) -> Fact:
            strangers = [o.name for o in atom.objects if o not in object_ids]
            if strangers:
                raise ValueError(f"{atom} mentions {strangers[0]}, which is not among the objects of the task")
            p = self.predicate_ids.setdefault(atom.predicate, len(self.predicate_ids))
            return (p, *(object_ids[o] for o in atom.objects))

        initial_facts = [number(a) for a in sorted(initial)]
        goal_facts = [number(a) for a in sorted(goal)]
        queue = list(dict.fromkeys(initial_facts))
        for s, schema in enumerate(self.schemas):
            if not schema.pre:
                self._complete(s, [-1] * len(schema.allowed), queue)
        head = 0
        while head < len(queue):
            fact = queue[head]
            head += 1
            if fact not in self.facts:
                self.facts[fact] = len(self.facts)
                for positions in self.patterns[fact[0]]:
                    self.index[fact[0], positions, tuple(fact[i] for i in positions)].append(fact)
                for s, i in self.triggers[fact[0]]:
                    self._join(s, i, fact, queue)
        return self._task(initial_facts, goal_facts)

    def _join(self, s: int, i: int, fact: Fact, queue: list[Fact]) -> None:
        """Instances of schema ``s`` whose precondition ``i`` is ``fact``, all others known."""
        schema = self.schemas[s]
        binding = [-1] * len(schema.allowed)
        if self._bind(schema, schema.pre[i], fact, binding):
            for complete in self._extend(schema, schema.join_orders[i], 0, binding):
                self._complete(s, complete, queue)

    def _extend(
        self, schema: _Schema, order: list[tuple[Fact, tuple[int, ...]]], k: int, binding: Binding
    ) -> Iterator[Binding]:
        if k == len(order):
            yield binding
            return
        precondition, positions = order[k]
        key = (precondition[0], positions, tuple(binding[precondition[i]] for i in positions))
        for fact in self.index.get(key, ()):
            extended = binding.copy()
            if self._bind(schema, precondition, fact, extended):
                yield from self._extend(schema, order, k + 1, extended)

    def _bind(self, schema: _Schema, precondition: Fact, fact: Fact, binding: Binding) -> bool:
        """Match ``precondition`` with ``fact``, extending ``binding`` in place; False when they do not fit."""
        for variable, value in zip(precondition[1:], fact[1:], strict=True):
            if binding[variable] == -1:
                if value not in schema.allowed[variable] or (self.distinct and value in binding):
                    return False
                binding[variable] = value
            elif binding[variable] != value:
                return False
        return True

    def _complete(self, s: int, binding: Binding, queue: list[Fact]) -> None:
        """Bind the parameters that no precondition mentions to every fitting object; record the instances."""
        schema = self.schemas[s]
        if -1 in binding:
            variable = binding.index(-1)
            for value in sorted(schema.allowed[variable]):
                if not (self.distinct and value in binding):
                    self._complete(s, [*binding[:variable], value, *binding[variable + 1 :]], queue)
            return
        instance = (s, tuple(binding))
        if instance in self.instances:
            return
        if len(self.instances) >= self.budget:
            raise GroundingBudgetError(f"more than {self.budget} ground operators are reachable")
        self.instances[instance] = None
        for effect in schema.add:
            fact = (effect[0], *(binding[v] for v in effect[1:]))
            if fact not in self.facts:
                queue.append(fact)

    def _task(self, initial: list[Fact], goal: list[Fact]) -> GroundTask:
        """Number facts and operators independently of the order in which they were found."""
        predicates = list(self.predicate_ids)
        atoms = {Atom(predicates[f[0]], tuple(self.objects[i] for i in f[1:])): f for f in self.facts}
        ordered = sorted(atoms)
        bit = {atoms[a]: 1 << i for i, a in enumerate(ordered)}
        instances = sorted(self.instances)

        def mask(lifted: tuple[Fact, ...], binding: tuple[int, ...]) -> int:
            result = 0
            for effect in lifted:
                result |= bit.get((effect[0], *(binding[v] for v in effect[1:])), 0)
            return result

        strips = Strips(
            facts=len(ordered),
            pre=tuple(mask(self.schemas[s].pre, b) for s, b in instances),
            add=tuple(mask(self.schemas[s].add, b) for s, b in instances),
            delete=tuple(mask(self.schemas[s].delete, b) for s, b in instances),
            initial=sum(bit[f] for f in set(initial)),
            goal=sum(bit.get(f, 0) for f in set(goal)),
        )
        return GroundTask(
            strips,
            tuple(ordered),
            tuple((self.schemas[s].operator, tuple(self.objects[i] for i in b)) for s, b in instances),
            all(f in bit for f in goal),
        )
