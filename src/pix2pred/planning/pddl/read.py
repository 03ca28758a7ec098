"""Reading typed STRIPS PDDL, with errors that name the line.

Covers what the project writes and the published domains use: ``:strips``, ``:typing``, ``:equality`` for distinct
parameters, ``:constants`` outside actions. Action costs are read over: every action counts one. Everything else is an
error. Own code because the parsers found either refuse the built-in type ``object`` in a predicate (``pddl`` 0.5) or
weigh a planning framework (``unified-planning``), and none reports lines for such errors.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import permutations
from typing import TypeVar

from pix2pred.planning.pddl.parts import (
    RESERVED,
    action_parts,
    conjuncts,
    declared,
    initial_facts,
    items,
    negated,
    sections,
)
from pix2pred.planning.pddl.syntax import Group, PddlError, Word, as_group, as_word
from pix2pred.structs import (
    AbstractState,
    Atom,
    FromDomain,
    LiftedAtom,
    Object,
    Operator,
    Predicate,
    Skill,
    Type,
    Variable,
)

T = TypeVar("T")

MAX_TYPE_DEPTH = 100

_TABLE = re.compile(r"^\s*;@ name (\w+) (\S+) (.+?)\s*$", re.MULTILINE)
_SKILL = re.compile(r"^\s*;@ skill (\S+) (\d{1,9}) (.+?)\s*$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class PddlDomain:
    """Types, constants, predicates (source: domain) and operators.

    ``distinct`` tells that every action excludes coinciding parameters wherever types allow them to coincide.
    """

    name: str
    types: tuple[Type, ...]
    constants: tuple[Object, ...]
    predicates: tuple[Predicate, ...]
    operators: tuple[Operator, ...]
    distinct: bool
    names: Mapping[tuple[str, str], str] = field(default_factory=dict)
    """Original names by kind and PDDL form, where the two differ; problems may use either."""


@dataclass(frozen=True, slots=True)
class PddlProblem:
    """Objects (the domain's constants included), initial atoms and goal atoms."""

    name: str
    objects: tuple[Object, ...]
    initial: AbstractState
    goal: tuple[Atom, ...]


def read_domain(text: str) -> PddlDomain:
    """Read a domain. Raises ``PddlError``."""
    return _DomainReader(text).read()


def read_problem(text: str, domain: PddlDomain) -> PddlProblem:
    """Read a problem of ``domain``. Raises ``PddlError``."""
    found = sections(text, "problem")
    table = {**domain.names, **_original_names(text)}
    _check_domain(found, table, domain)
    types = {t.name: t for t in domain.types} | {"object": _root(domain.types)}
    things = {o.name: o for o in domain.constants}
    for word, type_word in declared(items(found, ":objects"), "object"):
        name = table.get(("object", word.text), word.text)
        if name in things:
            raise PddlError(word.line, f"object {word.text} is declared twice")
        things[name] = Object(name, _look_up(types, table, "type", type_word), name)
    predicates = {p.name: p for p in domain.predicates}

    def atom(group: Group) -> Atom:
        predicate = _look_up(predicates, table, "predicate", as_word(group.items[0] if group.items else group))
        args = tuple(_look_up(things, table, "object", as_word(i)) for i in group.items[1:])
        _check_arguments(group, predicate, [o.type for o in args])
        return Atom(predicate, args)

    initial = frozenset(atom(group) for group in initial_facts(items(found, ":init")))
    wanted = items(found, ":goal")
    if len(wanted) != 1:
        raise PddlError(found[":goal"][0].line, ":goal takes one condition")
    goal = []
    for group in conjuncts(as_group(wanted[0])):
        if group.head == "not":
            negated(group)
            raise PddlError(group.line, "negative goals are not supported")
        goal.append(atom(group))
    if any(a.predicate == UNEQUAL for op in domain.operators for a in op.preconditions):
        initial |= {Atom(UNEQUAL, pair) for pair in permutations(sorted(things.values()), 2)}
    return PddlProblem(as_word(found["problem"][0].items[1]).text, tuple(sorted(things.values())), initial, tuple(goal))


def _check_domain(found: dict[str, list[Group]], table: Mapping[tuple[str, str], str], domain: PddlDomain) -> None:
    """Whether a problem has all it needs and is one of ``domain``."""
    for keyword in (":domain", ":init", ":goal"):
        if keyword not in found:
            raise PddlError(found["problem"][0].line, f"the problem has no {keyword}")
    group = found[":domain"][0]
    if len(group.items) != 2:
        raise PddlError(group.line, "(:domain ...) takes one name")
    word = as_word(group.items[1])
    if table.get(("domain", word.text), word.text) != domain.name:
        raise PddlError(word.line, f"this is a problem of the domain {word.text}, not of {domain.name}")


class _DomainReader:
    def __init__(self, text: str) -> None:
        self._sections = sections(text, "domain")
        self._table = _original_names(text)
        self._skills = {m[0]: (int(m[1]), m[2].split()) for m in _SKILL.findall(text)}
        self._declared: set[str] = set()
        self._actions: set[str] = set()
        self._unequal: list[tuple[set[frozenset[str]], bool]] = []

    def read(self) -> PddlDomain:
        """The domain, names resolved."""
        types = self._types()
        self._type_of = {t.name: t for t in types} | {"object": _root(types)}
        constants = tuple(
            Object(self._original("object", w.text), self._type(t), w.text)
            for w, t in declared(items(self._sections, ":constants"), "constant")
        )
        self._constants = {o.name for o in constants}
        predicates = [self._predicate(as_group(node)) for node in items(self._sections, ":predicates")]
        self._predicates = {p.name: p for p in predicates}
        operators = tuple(self._operator(a) for a in self._sections.get(":action", ()))
        distinct = all(complete for _, complete in self._unequal)
        if not distinct:
            operators = tuple(_with_inequalities(op, u) for op, (u, _) in zip(operators, self._unequal, strict=True))
        name = self._original("domain", as_word(self._sections["domain"][0].items[1]).text)
        return PddlDomain(name, types, constants, tuple(sorted(predicates)), operators, distinct, self._table)

    def _original(self, kind: str, form: str) -> str:
        return self._table.get((kind, form), form)

    def _types(self) -> tuple[Type, ...]:
        parents: dict[str, Word] = {}
        for word, parent in declared(items(self._sections, ":types"), "type"):
            if word.text != "object":
                parents[word.text] = parent
        root = Type("object")
        built: dict[str, Type] = {"object": root}
        depth = {"object": 0}

        def build(name: str, below: tuple[str, ...]) -> Type:
            if len(below) > MAX_TYPE_DEPTH:
                raise PddlError(parents[name].line, f"types are nested more than {MAX_TYPE_DEPTH} deep")
            if name in below:
                raise PddlError(parents[name].line, f"type {name} is its own ancestor")
            if name not in built:
                parent = parents[name]
                if parent.text != "object" and parent.text not in parents:
                    raise PddlError(parent.line, f"type {parent.text} is not declared")
                above = build(parent.text, (*below, name))
                depth[name] = depth[parent.text] + 1
                if depth[name] > MAX_TYPE_DEPTH:
                    raise PddlError(parent.line, f"types are nested more than {MAX_TYPE_DEPTH} deep")
                built[name] = Type(self._original("type", name), parent=above)
            return built[name]

        return tuple(build(name, ()) for name in ("object", *parents))

    def _type(self, word: Word) -> Type:
        return _look_up(self._type_of, self._table, "type", word)

    def _predicate(self, group: Group) -> Predicate:
        word = as_word(group.items[0] if group.items else group)
        if word.text in RESERVED:
            raise PddlError(word.line, f"{word.text} cannot name a predicate")
        if word.text in self._declared:
            raise PddlError(word.line, f"predicate {word.text} is declared twice")
        self._declared.add(word.text)
        types = tuple(self._type(t) for _, t in declared(group.items[1:], "variable"))
        return Predicate(self._original("predicate", word.text), types, FromDomain())

    def _operator(self, group: Group) -> Operator:
        word, parts = action_parts(group)
        form = word.text
        if form in self._actions:
            raise PddlError(word.line, f"action {form} is declared twice")
        self._actions.add(form)
        parameters = declared(parts[":parameters"].items, "variable") if ":parameters" in parts else ()
        variables = {w.text: Variable(w.text, self._type(t)) for w, t in parameters}
        pre, unequal = self._conditions(parts.get(":precondition"), variables)
        add, delete = self._effects(parts.get(":effect"), variables)
        self._unequal.append((unequal, unequal >= _overlapping(list(variables.values()))))
        support, skill = self._skills.get(form, (0, [form, *variables]))
        unknown = [v for v in skill[1:] if v not in variables]
        if unknown:
            raise PddlError(
                group.line, f"action {form}: its ;@ skill comment names {unknown[0]}, which is no parameter"
            )
        args = tuple(variables[v] for v in skill[1:])
        name = self._original("action", form)
        behind = Skill(skill[0], tuple(v.type for v in args))
        return Operator(name, tuple(variables.values()), pre, add, delete - add, behind, args, support)

    def _conditions(
        self, node: Group | None, variables: dict[str, Variable]
    ) -> tuple[frozenset[LiftedAtom], set[frozenset[str]]]:
        atoms, unequal = set(), set()
        for part in conjuncts(node):
            if part.head == "not":
                unequal.add(self._different(part, variables))
            else:
                atoms.add(self._lifted(part, variables))
        return frozenset(atoms), unequal

    def _different(self, part: Group, variables: dict[str, Variable]) -> frozenset[str]:
        """The two parameters of ``(not (= ?a ?b))``."""
        inner = negated(part)
        if inner.head != "=":
            raise PddlError(part.line, "negative preconditions other than (not (= ?a ?b)) are not supported")
        words = [self._parameter(i, variables) for i in inner.items[1:]]
        if len(words) != 2 or words[0] == words[1]:
            raise PddlError(inner.line, "(not (= ...)) takes two different parameters")
        return frozenset(words)

    def _effects(
        self, node: Group | None, variables: dict[str, Variable]
    ) -> tuple[frozenset[LiftedAtom], frozenset[LiftedAtom]]:
        add, delete = set(), set()
        for part in conjuncts(node):
            if part.head == "not":
                delete.add(self._lifted(negated(part), variables))
            else:
                add.add(self._lifted(part, variables))
        return frozenset(add), frozenset(delete)

    def _lifted(self, group: Group, variables: dict[str, Variable]) -> LiftedAtom:
        predicate = _look_up(
            self._predicates, self._table, "predicate", as_word(group.items[0] if group.items else group)
        )
        args = tuple(variables[self._parameter(i, variables)] for i in group.items[1:])
        _check_arguments(group, predicate, [v.type for v in args])
        return LiftedAtom(predicate, args)

    def _parameter(self, node: Word | Group, variables: dict[str, Variable]) -> str:
        """The name of a parameter, checked."""
        word = as_word(node)
        if word.text not in variables:
            kind = "constants in actions are not supported" if word.text in self._constants else "is no parameter"
            raise PddlError(word.line, f"{word.text}: {kind}")
        return word.text


UNEQUAL = Predicate("=/=", (Type("object"), Type("object")), FromDomain())
"""Stands for ``(not (= ?a ?b))`` where only some pairs of parameters exclude each other; problems get its atoms."""


def _with_inequalities(operator: Operator, pairs: set[frozenset[str]]) -> Operator:
    by_name = {v.name: v for v in operator.parameters}
    atoms = {LiftedAtom(UNEQUAL, tuple(by_name[n] for n in sorted(pair))) for pair in pairs if len(pair) == 2}
    return replace(operator, preconditions=operator.preconditions | atoms)


def _overlapping(variables: Sequence[Variable]) -> set[frozenset[str]]:
    return {
        frozenset((a.name, b.name))
        for i, a in enumerate(variables)
        for b in variables[i + 1 :]
        if a.type.is_a(b.type) or b.type.is_a(a.type)
    }


def _check_arguments(group: Group, predicate: Predicate, types: Sequence[Type]) -> None:
    if len(types) != predicate.arity:
        raise PddlError(group.line, f"{predicate.name} takes {predicate.arity} arguments, found {len(types)}")
    for wanted, found in zip(predicate.types, types, strict=True):
        if not found.is_a(wanted):
            raise PddlError(group.line, f"{predicate.name}: a {found.name} is given where a {wanted.name} is due")


def _root(types: Sequence[Type]) -> Type:
    return next((t for t in types if t.name == "object"), Type("object"))


def _look_up(known: Mapping[str, T], table: Mapping[tuple[str, str], str], kind: str, word: Word) -> T:
    name = table.get((kind, word.text), word.text)
    if name not in known:
        raise PddlError(word.line, f"{kind} {word.text} is not declared")
    return known[name]


def _original_names(text: str) -> dict[tuple[str, str], str]:
    return {(kind, form): name for kind, form, name in _TABLE.findall(text)}
