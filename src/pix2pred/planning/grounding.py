"""Grounding by semi-naive evaluation of the delete relaxation (delta grounding).

An operator is instantiated only with facts that are reachable when deletes are ignored. Every round joins one *new*
fact with facts already known, so each instance is found without ever enumerating all tuples of objects. The idea is
that of Datalog-based grounding (Helmert, "Concise finite-domain representations for PDDL planning tasks", 2009).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from operator import itemgetter

from pix2pred.planning.strips import Strips
from pix2pred.structs import AbstractState, Atom, LiftedAtom, Object, Operator, Predicate
from pix2pred.system.errors import Pix2predError

Fact = tuple[int, ...]
"""Predicate number followed by object numbers."""

Binding = list[int]
"""Object number of each operator parameter; -1 while unbound."""

DEFAULT_BUDGET = 200_000


class GroundingBudgetError(Pix2predError, RuntimeError):
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


@dataclass(frozen=True, slots=True)
class _Table:
    """The known facts of one predicate by their arguments at some positions."""

    key: Callable[[Sequence[int]], object]
    rows: dict[object, list[Fact]]

    def insert(self, fact: Fact) -> None:
        """Enter a new fact."""
        self.rows.setdefault(self.key(fact), []).append(fact)


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
        self.binds = tuple(sum(1 << v for v in set(p[1:])) for p in self.pre)
        self.access: dict[tuple[int, int], tuple[_Table, Callable[[Sequence[int]], object]]] = {}
        """(precondition, bound parameters as bits): the table to look in, and the key that a binding gives."""


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
        self.facts: dict[Fact, None] = {}
        self.queue: list[Fact] = []
        self.instances: dict[tuple[int, tuple[int, ...]], None] = {}
        self.tables: dict[int, dict[tuple[int, ...], _Table]] = defaultdict(dict)
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
        self.queue.extend(dict.fromkeys(initial_facts))
        for s, schema in enumerate(self.schemas):
            if not schema.pre:
                self._complete(s, [-1] * len(schema.allowed))
        for fact in self.queue:  # grows while it is worked off
            if fact not in self.facts:
                self.facts[fact] = None
                for table in self.tables[fact[0]].values():
                    table.insert(fact)
                for s, i in self.triggers[fact[0]]:
                    self._join(s, i, fact)
        return self._task(initial_facts, goal_facts)

    def _join(self, s: int, i: int, fact: Fact) -> None:
        """Instances of schema ``s`` whose precondition ``i`` is ``fact``, all others known."""
        schema = self.schemas[s]
        binding = [-1] * len(schema.allowed)
        if self._bind(schema, schema.pre[i], fact, binding):
            rest = tuple(k for k in range(len(schema.pre)) if k != i)
            self._extend(s, rest, schema.binds[i], binding)

    def _extend(self, s: int, rest: tuple[int, ...], bound: int, binding: Binding) -> None:
        """Match the preconditions ``rest``, the one with the fewest matches first: counted, not guessed."""
        if not rest:
            self._complete(s, binding)
            return
        schema = self.schemas[s]
        best, fewest = -1, None
        for k in rest:
            table, key = schema.access.get((k, bound)) or self._access(schema, k, bound)
            rows = table.rows.get(key(binding))
            if rows is None:
                return
            if fewest is None or len(rows) < len(fewest):
                best, fewest = k, rows
        assert fewest is not None, "there is a precondition left"
        precondition = schema.pre[best]
        left = tuple(k for k in rest if k != best)
        if bound | schema.binds[best] == bound:
            self._extend(s, left, bound, binding)
            return
        for fact in fewest:
            extended = binding.copy()
            if self._bind(schema, precondition, fact, extended):
                self._extend(s, left, bound | schema.binds[best], extended)

    def _access(self, schema: _Schema, k: int, bound: int) -> tuple[_Table, Callable[[Sequence[int]], object]]:
        """Where to look for matches of precondition ``k`` when the parameters ``bound`` are; made when first needed."""
        predicate, *variables = schema.pre[k]
        positions = tuple(i for i, v in enumerate(variables, start=1) if bound >> v & 1)
        tables = self.tables[predicate]
        if positions not in tables:
            tables[positions] = _Table(_pick(positions), {})
            for fact in self.facts:
                if fact[0] == predicate:
                    tables[positions].insert(fact)
        schema.access[k, bound] = tables[positions], _pick(tuple(variables[i - 1] for i in positions))
        return schema.access[k, bound]

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

    def _complete(self, s: int, binding: Binding) -> None:
        """Bind the parameters that no precondition mentions to every fitting object; record the instances."""
        schema = self.schemas[s]
        if -1 in binding:
            variable = binding.index(-1)
            for value in sorted(schema.allowed[variable]):
                if not (self.distinct and value in binding):
                    self._complete(s, [*binding[:variable], value, *binding[variable + 1 :]])
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
                self.queue.append(fact)

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


def _pick(positions: tuple[int, ...]) -> Callable[[Sequence[int]], object]:
    """A function that gives the values at ``positions``."""
    return itemgetter(*positions) if positions else lambda _: ()
