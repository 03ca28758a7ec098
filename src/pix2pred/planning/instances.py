"""Instances of operator schemas by semi-naive evaluation of the delete relaxation (delta grounding), in numbers.

A schema is instantiated only with facts that are reachable when deletes are ignored. Every round joins one *new* fact
with facts already known, so each instance is found without ever enumerating all tuples of objects. The idea is that of
Datalog-based grounding (Helmert, "Concise finite-domain representations for PDDL planning tasks", 2009).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from operator import itemgetter

from pix2pred.system.errors import Pix2predError

Fact = tuple[int, ...]
"""Predicate number followed by object numbers; in a schema, by parameter numbers."""

Binding = list[int]
"""Object number of each parameter; -1 while unbound."""

Key = Callable[[Sequence[int]], object]

TRIES_PER_INSTANCE = 64
"""Values tried for parameters per instance that the budget allows. Not tuned: room for bad orders."""


CHEAP_PARAMETERS = 4
"""Parameters whose bookkeeping costs as much as trying a value. An operator of 40 then ends within some seconds."""


class GroundingBudgetError(Pix2predError, RuntimeError):
    """The task has more ground operators than the budget allows, or finding them takes more work than that."""


@dataclass(slots=True)
class Schema:
    """What is instantiated: objects that each parameter may be, preconditions, and what becomes true.

    ``apart[v]`` lists the parameters that must be other objects than parameter ``v``.
    """

    allowed: Sequence[frozenset[int]]
    pre: tuple[Fact, ...]
    add: tuple[Fact, ...]
    apart: Sequence[tuple[int, ...]]
    name: str = ""
    """What messages call it."""
    binds: tuple[int, ...] = ()
    """Parameters of each precondition, as bits."""
    fixed: Binding = field(default_factory=list)
    """Parameters that can be one object alone, such as constants, are that object from the beginning."""
    known: int = 0
    """The fixed parameters, as bits."""
    access: dict[tuple[int, int], tuple[_Table, Key]] = field(default_factory=dict)
    """(precondition, bound parameters as bits): the table to look in, and the key that a binding gives."""

    def __post_init__(self) -> None:
        self.binds = tuple(sum(1 << v for v in set(p[1:])) for p in self.pre)
        self.fixed = [next(iter(values)) if len(values) == 1 else -1 for values in self.allowed]
        self.known = sum(1 << v for v, value in enumerate(self.fixed) if value >= 0)

    @property
    def cost(self) -> int:
        """What trying one value takes, in values of an operator with few parameters."""
        return max(1, len(self.allowed) // CHEAP_PARAMETERS)

    def impossible(self) -> bool:
        """Whether parameters that must be different cannot be, because objects are too few."""
        for value, others in zip(self.fixed, self.apart, strict=True):
            if value >= 0 and any(self.fixed[w] == value for w in others):
                return True
        together: list[int] = []
        for v, others in enumerate(self.apart):
            if all(w in others for w in together):
                together.append(v)
        return len(together) > len(frozenset().union(*(self.allowed[v] for v in together)))


def all_apart(count: int) -> list[tuple[int, ...]]:
    """``Schema.apart`` for ``count`` parameters that are all different objects."""
    return [tuple(w for w in range(count) if w != v) for v in range(count)]


@dataclass(frozen=True, slots=True)
class _Table:
    """The known facts of one predicate by their arguments at some positions."""

    key: Key
    rows: dict[object, list[Fact]]

    def insert(self, fact: Fact) -> None:
        """Enter a new fact."""
        self.rows.setdefault(self.key(fact), []).append(fact)


class Instances:
    """Reachable ``facts`` and ``found`` instances, each a schema number with a binding, in the order of finding.

    Raises ``GroundingBudgetError`` when there are more than ``budget`` instances, or work beyond all proportion to it.
    """

    def __init__(self, schemas: Sequence[Schema], initial: Iterable[Fact], budget: int) -> None:
        self.facts: dict[Fact, None] = {}
        self.found: dict[tuple[int, tuple[int, ...]], None] = {}
        self._schemas = schemas
        self._budget = budget
        self._tries = budget * TRIES_PER_INSTANCE
        self._queue = list(dict.fromkeys(initial))
        self._by_predicate: dict[int, list[Fact]] = defaultdict(list)
        self._tables: dict[int, dict[tuple[int, ...], _Table]] = defaultdict(dict)
        triggers: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for s, schema in enumerate(schemas):
            for i, precondition in enumerate(schema.pre if not schema.impossible() else ()):
                triggers[precondition[0]].append((s, i))
        for s, schema in enumerate(schemas):
            if not schema.pre and not schema.impossible():
                self._complete(s, schema.fixed)
        for fact in self._queue:  # grows while it is worked off
            if fact not in self.facts:
                self.facts[fact] = None
                self._by_predicate[fact[0]].append(fact)
                for table in self._tables[fact[0]].values():
                    table.insert(fact)
                for s, i in triggers[fact[0]]:
                    self._join(s, i, fact)

    def _join(self, s: int, i: int, fact: Fact) -> None:
        """Instances of schema ``s`` whose precondition ``i`` is ``fact``, all others known."""
        schema = self._schemas[s]
        binding = schema.fixed.copy()
        if _bind(schema, schema.pre[i], fact, binding):
            rest = tuple(k for k in range(len(schema.pre)) if k != i)
            self._extend(s, rest, schema.known | schema.binds[i], binding)

    def _extend(self, s: int, rest: tuple[int, ...], bound: int, binding: Binding) -> None:
        """Match the preconditions ``rest``, the one with the fewest matches first: counted, not guessed."""
        if not rest:
            self._complete(s, binding)
            return
        schema = self._schemas[s]
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
        self._try(schema, len(fewest))
        for fact in fewest:
            extended = binding.copy()
            if _bind(schema, precondition, fact, extended):
                self._extend(s, left, bound | schema.binds[best], extended)

    def _access(self, schema: Schema, k: int, bound: int) -> tuple[_Table, Key]:
        """Where to look for matches of precondition ``k`` when the parameters ``bound`` are; made when first needed."""
        predicate, *variables = schema.pre[k]
        positions = tuple(i for i, v in enumerate(variables, start=1) if bound >> v & 1)
        tables = self._tables[predicate]
        if positions not in tables:
            tables[positions] = _Table(_pick(positions), {})
            for fact in self._by_predicate[predicate]:
                tables[positions].insert(fact)
        schema.access[k, bound] = tables[positions], _pick(tuple(variables[i - 1] for i in positions))
        return schema.access[k, bound]

    def _complete(self, s: int, binding: Binding) -> None:
        """Bind what no precondition binds, in every way, and register the instances."""
        schema = self._schemas[s]
        if -1 in binding:
            variable = binding.index(-1)
            self._try(schema, len(schema.allowed[variable]))
            taken = {binding[w] for w in schema.apart[variable]}
            for value in sorted(schema.allowed[variable]):
                if value not in taken:
                    self._complete(s, [*binding[:variable], value, *binding[variable + 1 :]])
            return
        instance = (s, tuple(binding))
        if instance in self.found:
            return
        if len(self.found) >= self._budget:
            raise GroundingBudgetError(f"{schema.name}: more than {self._budget} ground operators are reachable")
        self.found[instance] = None
        for effect in schema.add:
            fact = (effect[0], *(binding[v] for v in effect[1:]))
            if fact not in self.facts:
                self._queue.append(fact)

    def _try(self, schema: Schema, values: int) -> None:
        """Account for ``values`` that are tried for a parameter."""
        self._tries -= values * schema.cost
        if self._tries < 0:
            raise GroundingBudgetError(
                f"{schema.name}: finding its ground operators, {len(self.found)} so far, takes more work "
                f"than a budget of {self._budget} allows; it has {len(schema.allowed)} parameters"
            )


def _bind(schema: Schema, precondition: Fact, fact: Fact, binding: Binding) -> bool:
    """Match ``precondition`` with ``fact``, extending ``binding`` in place; False when they do not fit."""
    for variable, value in zip(precondition[1:], fact[1:], strict=True):
        if binding[variable] == -1:
            if value not in schema.allowed[variable]:
                return False
            for other in schema.apart[variable]:
                if binding[other] == value:
                    return False
            binding[variable] = value
        elif binding[variable] != value:
            return False
    return True


def _pick(positions: tuple[int, ...]) -> Key:
    """A function that gives the values at ``positions``."""
    return itemgetter(*positions) if positions else lambda _: ()
