"""Reading PDDL without numbers and time, with errors that name line and column.

Own code because the parsers found either refuse the built-in type ``object`` in a predicate (``pddl`` 0.5) or weigh a
planning framework (``unified-planning``), and none reports where such errors stand.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import permutations

from pix2pred.planning.pddl.conditions import FormulaReader, whole_number
from pix2pred.planning.pddl.formulas import TRUE, DerivedPredicate, Formula, Literal, PddlAction, TypedName, conjuncts
from pix2pred.planning.pddl.operators import UNEQUAL, StripsOperators, skill_notes, strips_operators
from pix2pred.planning.pddl.parts import NO_PREDICATES, action_parts, declared, items, sections
from pix2pred.planning.pddl.scope import Scope, read_types
from pix2pred.planning.pddl.stratified import CircularNegationError, strata
from pix2pred.planning.pddl.syntax import Group, Node, PddlError, Place, Word, as_group, as_word
from pix2pred.structs import AbstractState, Atom, FromDomain, Object, Operator, Predicate, Type

_TABLE = re.compile(r"^\s*;@ name (\w+) (\S+) (.+?)\s*$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class PddlDomain:
    """A domain: types, constants, predicates (source: domain), actions, derived predicates and functions.

    ``operators`` are the actions where all of them are operators of STRIPS over variables; ``distinct`` then tells that
    every action excludes coinciding parameters wherever types allow them to coincide. Otherwise there are none, and
    ``is_strips`` is False.
    """

    name: str
    types: tuple[Type, ...]
    constants: tuple[Object, ...]
    predicates: tuple[Predicate, ...]
    operators: tuple[Operator, ...]
    distinct: bool
    names: Mapping[tuple[str, str], str] = field(default_factory=dict)
    """Original names by kind and PDDL form, where the two differ; problems may use either."""
    is_strips: bool = True
    actions: tuple[PddlAction, ...] = ()
    derived: tuple[DerivedPredicate, ...] = ()
    levels: tuple[frozenset[str], ...] = ()
    """The derived predicates in the order in which they are evaluated."""
    signatures: Mapping[str, tuple[TypedName, ...]] = field(default_factory=dict)
    """Parameters of every predicate, with all their types where ``either`` gives several."""
    functions: Mapping[str, tuple[TypedName, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class PddlProblem:
    """A problem: objects (the domain's constants included), initial atoms, and what is to be reached.

    ``condition`` is the goal. ``goal`` lists its atoms when it is a conjunction of atoms (``has_atomic_goal``), and is
    empty otherwise. ``costs`` are the values of static functions; with ``minimise_costs`` the cheapest plan is wanted,
    otherwise the shortest.
    """

    name: str
    objects: tuple[Object, ...]
    initial: AbstractState
    goal: tuple[Atom, ...]
    condition: Formula = TRUE
    has_atomic_goal: bool = True
    costs: Mapping[tuple[str, tuple[str, ...]], int] = field(default_factory=dict)
    minimise_costs: bool = False
    kinds: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Types of every object, several where ``either`` gives them."""
    names: Mapping[tuple[str, str], str] = field(default_factory=dict)
    """Original names by kind and PDDL form, the domain's included."""


def read_domain(text: str) -> PddlDomain:
    """Read a domain. Raises ``PddlError``."""
    found = sections(text, "domain")
    scope = Scope(_original_names(text))
    read_types(list(declared(items(found, ":types"), "type", repeatable=True)), scope)
    constants = _objects(found, ":constants", scope)
    for node in items(found, ":predicates"):
        _declare(as_group(node), "predicate", scope.predicates, scope)
    for node in _without_types(items(found, ":functions")):
        _declare(as_group(node), "function", scope.functions, scope)
    reader = FormulaReader(scope)
    derived = tuple(_derived(g, scope, reader) for g in found.get(":derived", ()))
    try:
        levels = strata(derived)
    except CircularNegationError as error:
        raise PddlError(found[":derived"][0].at, f"{error} is derived from its own negation") from error
    actions: dict[str, PddlAction] = {}
    places: dict[str, Place] = {}
    for group in found.get(":action", ()):
        word, action = _action(group, scope, reader, {d.head for d in derived})
        if action.name in actions:
            raise PddlError(word.at, f"action {word.text} is declared twice")
        actions[action.name], places[action.name] = action, word.at
    predicates = {
        n: Predicate(n, tuple(_one_type(p, scope) for p in s), FromDomain()) for n, s in scope.predicates.items()
    }
    notes = {scope.original("action", form): note for form, note in skill_notes(text).items()}
    strips = None if derived else strips_operators(tuple(actions.values()), scope.types, predicates, notes, places)
    made = strips or StripsOperators((), distinct=False)
    return PddlDomain(
        name=scope.original("domain", as_word(found["domain"][0].items[1]).text),
        types=tuple(scope.types.values()),
        constants=constants,
        predicates=tuple(sorted(predicates.values())),
        operators=made.operators,
        distinct=made.distinct,
        names=scope.table,
        is_strips=strips is not None,
        actions=tuple(actions.values()),
        derived=derived,
        levels=levels,
        signatures=scope.predicates,
        functions=scope.functions,
    )


def read_problem(text: str, domain: PddlDomain) -> PddlProblem:
    """Read a problem of ``domain``. Raises ``PddlError``."""
    found = sections(text, "problem")
    scope = Scope({**domain.names, **_original_names(text)})
    scope.types.update({t.name: t for t in domain.types})
    scope.predicates.update(domain.signatures)
    scope.functions.update(domain.functions)
    scope.objects.update({o.name: (o.type.name,) for o in domain.constants})
    _check_domain(found, scope, domain)
    things = tuple(sorted((*domain.constants, *_objects(found, ":objects", scope))))
    reader = FormulaReader(scope)
    wanted = items(found, ":goal")
    if len(wanted) != 1:
        raise PddlError(found[":goal"][0].at, ":goal takes one condition")
    condition = reader.condition(wanted[0], {})
    predicates, objects = {p.name: p for p in domain.predicates}, {o.name: o for o in things}

    def atom(literal: Literal) -> Atom:
        return Atom(predicates[literal.predicate], tuple(objects[t] for t in literal.terms))

    facts, costs = _initial(items(found, ":init"), scope, reader, {d.head for d in domain.derived})
    initial = frozenset(atom(fact) for fact in facts)
    if any(a.predicate == UNEQUAL for op in domain.operators for a in op.preconditions):
        initial |= {Atom(UNEQUAL, pair) for pair in permutations(things, 2)}
    literals = [part for part in conjuncts(condition) if isinstance(part, Literal) and part.positive]
    atomic = len(literals) == len(conjuncts(condition))
    return PddlProblem(
        name=as_word(found["problem"][0].items[1]).text,
        objects=things,
        initial=initial,
        goal=tuple(map(atom, literals)) if atomic else (),
        condition=condition,
        has_atomic_goal=atomic,
        costs=costs,
        minimise_costs=_minimises_costs(found, domain),
        kinds=scope.objects,
        names=scope.table,
    )


def _check_domain(found: dict[str, list[Group]], scope: Scope, domain: PddlDomain) -> None:
    """Whether a problem has all it needs and is one of ``domain``."""
    for keyword in (":domain", ":init", ":goal"):
        if keyword not in found:
            raise PddlError(found["problem"][0].at, f"the problem has no {keyword}")
    group = found[":domain"][0]
    if len(group.items) != 2:
        raise PddlError(group.at, "(:domain ...) takes one name")
    word = as_word(group.items[1])
    if domain.name not in (word.text, scope.original("domain", word.text)):  # only one file may tell the full name
        raise PddlError(word.at, f"this is a problem of the domain {word.text}, not of {domain.name}")


def _objects(found: dict[str, list[Group]], keyword: str, scope: Scope) -> tuple[Object, ...]:
    """The constants or objects that a section declares, entered into ``scope``."""
    kind = "constant" if keyword == ":constants" else "object"
    made = []
    for word in declared(items(found, keyword), kind):
        typed = scope.typed(word, "object")
        if typed.name in scope.objects:
            raise PddlError(word.name.at, f"object {word.name.text} is declared twice")
        scope.objects[typed.name] = typed.types
        made.append(Object(typed.name, _one_type(typed, scope), word.name.text if kind == "constant" else typed.name))
    return tuple(made)


def _one_type(name: TypedName, scope: Scope) -> Type:
    """The type of ``name``, or the lowest one above all its types."""
    types = [scope.types[t] for t in name.types]
    above: Type | None = types[0]
    while above is not None and not all(t.is_a(above) for t in types):
        above = above.parent
    return above or scope.types["object"]


def _declare(group: Group, kind: str, known: dict[str, tuple[TypedName, ...]], scope: Scope) -> None:
    word = as_word(group.items[0]) if group.items else Word("()", group.at)
    name = scope.original(kind, word.text)
    if kind == "predicate" and word.text in NO_PREDICATES:
        raise PddlError(word.at, f"{word.text} cannot name a predicate")
    if name in known:
        raise PddlError(word.at, f"{kind} {word.text} is declared twice")
    known[name] = tuple(scope.typed(w) for w in declared(group.items[1:], "variable", repeatable=True))


def _without_types(nodes: Sequence[Node]) -> Sequence[Node]:
    """Declarations of functions without their type, which can only be ``number``."""
    kept: list[Node] = []
    words = iter(nodes)
    for node in words:
        if isinstance(node, Word) and node.text == "-":
            kind = next(words, None)
            if not isinstance(kind, Word) or kind.text != "number":
                raise PddlError(node.at, "functions whose values are objects are not supported")
        else:
            kept.append(node)
    return kept


def _derived(group: Group, scope: Scope, reader: FormulaReader) -> DerivedPredicate:
    if len(group.items) != 3:
        raise PddlError(group.at, "(:derived ...) takes a predicate with its variables and a condition")
    head = as_group(group.items[1])
    word = as_word(head.items[0]) if head.items else Word("()", head.at)
    signature = scope.look_up(scope.predicates, "predicate", word)
    given = tuple(scope.typed(w) for w in declared(head.items[1:], "variable"))
    if len(given) != len(signature):
        raise PddlError(head.at, f"{word.text} takes {len(signature)} arguments, found {len(given)}")
    body = reader.condition(group.items[2], {v.name: v for v in given})
    return DerivedPredicate(scope.original("predicate", word.text), given, body)


def _action(group: Group, scope: Scope, reader: FormulaReader, derived: set[str]) -> tuple[Word, PddlAction]:
    word, parts = action_parts(group)
    listed = parts[":parameters"].items if ":parameters" in parts else ()
    parameters = tuple(scope.typed(w) for w in declared(listed, "variable"))
    variables = {p.name: p for p in parameters}
    effects = tuple(reader.effects(parts.get(":effect"), variables))
    for effect in effects:
        if effect.literal.predicate in derived:
            raise PddlError(word.at, f"action {word.text} changes {effect.literal.predicate}, which is derived")
    action = PddlAction(
        scope.original("action", word.text),
        parameters,
        reader.condition(parts.get(":precondition"), variables),
        effects,
        tuple(reader.costs(parts.get(":effect"), variables)),
    )
    return word, action


def _initial(
    nodes: Sequence[Node], scope: Scope, reader: FormulaReader, derived: set[str]
) -> tuple[list[Literal], dict[tuple[str, tuple[str, ...]], int]]:
    """The facts of ``:init`` and the values of functions. What it says to be false must not be listed as well."""
    facts: list[Literal] = []
    costs: dict[tuple[str, tuple[str, ...]], int] = {}
    for group in map(as_group, nodes):
        second = group.items[1] if len(group.items) > 1 else None
        if group.head == "=":
            if len(group.items) != 3:
                raise PddlError(group.at, "(= ...) takes a function and its value")
            target = as_group(group.items[1])
            word = as_word(target.items[0]) if target.items else Word("()", target.at)
            if word.text == "total-cost":
                continue
            wanted = scope.look_up(scope.functions, "function", word)
            terms = scope.arguments(target, word.text, wanted, {})
            costs[word.text, terms] = whole_number(as_word(group.items[2]))
        elif group.head == "at" and len(group.items) == 3 and isinstance(group.items[2], Group):
            raise PddlError(group.at, "facts that become true at a time (at ...) are not supported")
        elif group.head == "not" and second is not None:
            denied = reader.atom(as_group(second), {})
            if denied in facts:
                raise PddlError(group.at, f"{denied.predicate} is said to be true and not to be true")
        else:
            fact = reader.atom(group, {})
            if fact.predicate in derived:
                raise PddlError(group.at, f"{fact.predicate} is derived and cannot be given")
            facts.append(fact)
    return facts, costs


def _minimises_costs(found: dict[str, list[Group]], domain: PddlDomain) -> bool:
    """Whether the cheapest plan is wanted. The shortest one has the smallest ``total-time``, without durations."""
    nodes = items(found, ":metric")
    if not nodes:
        return False
    group = found[":metric"][0]
    what = nodes[1] if len(nodes) == 2 else group
    target = what.text if isinstance(what, Word) else what.head
    if as_word(nodes[0]).text != "minimize" or target not in ("total-cost", "total-time"):
        raise PddlError(group.at, "only (:metric minimize (total-cost)) is supported")
    return target == "total-cost" and any(a.costs for a in domain.actions)


def _original_names(text: str) -> dict[tuple[str, str], str]:
    return {(kind, form): name for kind, form, name in _TABLE.findall(text)}
