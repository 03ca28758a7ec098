"""Reading typed STRIPS PDDL, with errors that name the line.

Covers what the project writes and the published domains use: ``:strips``, ``:typing``, ``:equality`` for distinct
parameters, ``:constants``. Own code because the parsers found either refuse the built-in type ``object`` in a
predicate (``pddl`` 0.5) or weigh a planning framework (``unified-planning``), and none reports lines for such errors.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import TypeVar

from pix2pred.planning.pddl_syntax import Group, PddlError, Word, as_group, as_word, parse, typed_list
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

_TABLE = re.compile(r"^\s*;@ name (\w+) (\S+) (.+?)\s*$", re.MULTILINE)
_SKILL = re.compile(r"^\s*;@ skill (\S+) (\d+) (.+?)\s*$", re.MULTILINE)


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
    sections = _sections(text, "problem")
    table = _original_names(text)
    types = {t.name: t for t in domain.types} | {"object": _root(domain.types)}
    things = {o.name: o for o in domain.constants}
    for word, type_word in typed_list(_rest(sections.get("objects"))):
        name = table.get(("object", word.text), word.text)
        things[name] = Object(name, _look_up(types, table, "type", type_word), name)
    predicates = {p.name: p for p in domain.predicates}

    def atom(node: Word | Group) -> Atom:
        group = as_group(node)
        predicate = _look_up(predicates, table, "predicate", as_word(group.items[0] if group.items else group))
        args = tuple(_look_up(things, table, "object", as_word(i)) for i in group.items[1:])
        _check_arguments(group, predicate, [o.type for o in args])
        return Atom(predicate, args)

    initial = frozenset(atom(node) for node in _rest(sections.get("init")) if not _is_cost(node))
    if "goal" not in sections:
        raise PddlError(1, "the problem has no :goal")
    wanted = _rest(sections["goal"])
    if len(wanted) != 1:
        raise PddlError(sections["goal"].line, ":goal takes one condition")
    goal = tuple(atom(node) for node in _conjuncts(wanted[0]))
    if any(a.predicate == UNEQUAL for op in domain.operators for a in op.preconditions):
        initial |= {Atom(UNEQUAL, pair) for pair in permutations(sorted(things.values()), 2)}
    return PddlProblem(as_word(sections["problem"].items[1]).text, tuple(sorted(things.values())), initial, goal)


class _DomainReader:
    def __init__(self, text: str) -> None:
        self._sections = _sections(text, "domain")
        self._table = _original_names(text)
        self._skills = {m[0]: (int(m[1]), m[2].split()) for m in _SKILL.findall(text)}
        self._unequal: list[tuple[set[frozenset[str]], bool]] = []

    def read(self) -> PddlDomain:
        """The domain, names resolved."""
        types = self._types()
        self._type_of = {t.name: t for t in types} | {"object": _root(types)}
        constants = tuple(
            Object(self._original("object", w.text), self._type(t), w.text)
            for w, t in typed_list(_rest(self._sections.get("constants")))
        )
        self._constants = {o.name for o in constants}
        predicates = [self._predicate(as_group(node)) for node in _rest(self._sections.get("predicates"))]
        self._predicates = {p.name: p for p in predicates}
        actions = [section for section in self._sections["domain"].items[2:] if as_group(section).head == ":action"]
        operators = tuple(self._operator(as_group(a)) for a in actions)
        distinct = all(complete for _, complete in self._unequal)
        if not distinct:
            operators = tuple(_with_inequalities(op, u) for op, (u, _) in zip(operators, self._unequal, strict=True))
        name = self._original("domain", as_word(as_group(self._sections["domain"].items[1]).items[1]).text)
        return PddlDomain(name, types, constants, tuple(sorted(predicates)), operators, distinct)

    def _original(self, kind: str, form: str) -> str:
        return self._table.get((kind, form), form)

    def _types(self) -> tuple[Type, ...]:
        parents: dict[str, Word] = {}
        for word, parent in typed_list(_rest(self._sections.get("types"))):
            if word.text != "object":
                parents[word.text] = parent
        root = Type("object")
        built: dict[str, Type] = {"object": root}

        def build(name: str, below: tuple[str, ...]) -> Type:
            if name in below:
                raise PddlError(parents[name].line, f"type {name} is its own ancestor")
            if name not in built:
                parent = parents[name]
                known = parent.text == "object" or parent.text in parents
                above = build(parent.text, (*below, name)) if known else Type(parent.text, parent=root)
                built[name] = Type(self._original("type", name), parent=above)
            return built[name]

        return tuple(build(name, ()) for name in ("object", *parents))

    def _type(self, word: Word) -> Type:
        return _look_up(self._type_of, self._table, "type", word)

    def _predicate(self, group: Group) -> Predicate:
        name = self._original("predicate", as_word(group.items[0] if group.items else group).text)
        return Predicate(name, tuple(self._type(t) for _, t in typed_list(group.items[1:])), FromDomain())

    def _operator(self, group: Group) -> Operator:
        form = _second(group).text
        parts = {as_word(key).text: value for key, value in zip(group.items[2::2], group.items[3::2], strict=False)}
        parameters = typed_list(as_group(parts[":parameters"]).items) if ":parameters" in parts else ()
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
        self, node: Word | Group | None, variables: dict[str, Variable]
    ) -> tuple[frozenset[LiftedAtom], set[frozenset[str]]]:
        atoms, unequal = set(), set()
        for part in _conjuncts(node):
            if part.head == "not":
                inner = _negated(part)
                if inner.head != "=":
                    raise PddlError(part.line, "negative preconditions other than (not (= ?a ?b)) are not supported")
                unequal.add(frozenset(as_word(i).text for i in inner.items[1:]))
            else:
                atoms.add(self._lifted(part, variables))
        return frozenset(atoms), unequal

    def _effects(
        self, node: Word | Group | None, variables: dict[str, Variable]
    ) -> tuple[frozenset[LiftedAtom], frozenset[LiftedAtom]]:
        add, delete = set(), set()
        for part in _conjuncts(node):
            if part.head == "not":
                delete.add(self._lifted(_negated(part), variables))
            elif part.head != "increase":
                add.add(self._lifted(part, variables))
        return frozenset(add), frozenset(delete)

    def _lifted(self, group: Group, variables: dict[str, Variable]) -> LiftedAtom:
        predicate = _look_up(
            self._predicates, self._table, "predicate", as_word(group.items[0] if group.items else group)
        )
        words = [as_word(i) for i in group.items[1:]]
        for word in words:
            if word.text not in variables:
                kind = "constants in actions are not supported" if word.text in self._constants else "is no parameter"
                raise PddlError(word.line, f"{word.text}: {kind}")
        args = tuple(variables[w.text] for w in words)
        _check_arguments(group, predicate, [v.type for v in args])
        return LiftedAtom(predicate, args)


UNEQUAL = Predicate("=/=", (Type("object"), Type("object")), FromDomain())
"""Stands for ``(not (= ?a ?b))`` where only some pairs of parameters exclude each other; problems get its atoms."""


def _with_inequalities(operator: Operator, pairs: set[frozenset[str]]) -> Operator:
    by_name = {v.name: v for v in operator.parameters}
    atoms = {LiftedAtom(UNEQUAL, tuple(by_name[n] for n in sorted(pair))) for pair in pairs if len(pair) == 2}
    return replace(operator, preconditions=operator.preconditions | atoms)


def _negated(group: Group) -> Group:
    if len(group.items) != 2:
        raise PddlError(group.line, "(not ...) takes one condition")
    return as_group(group.items[1])


def _second(group: Group) -> Word:
    if len(group.items) < 2:
        raise PddlError(group.line, f"{group.head} needs a name")
    return as_word(group.items[1])


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


def _look_up(known: dict[str, T], table: dict[tuple[str, str], str], kind: str, word: Word) -> T:
    name = table.get((kind, word.text), word.text)
    if name not in known:
        raise PddlError(word.line, f"{kind} {word.text} is not declared")
    return known[name]


def _original_names(text: str) -> dict[tuple[str, str], str]:
    return {(kind, form): name for kind, form, name in _TABLE.findall(text)}


def _sections(text: str, kind: str) -> dict[str, Group]:
    """The parts of a definition by keyword; ``kind`` holds the whole definition under its own name."""
    top = parse(text)
    if top.head != "define" or len(top.items) < 2 or as_group(top.items[1]).head != kind:
        raise PddlError(top.line, f"expected (define ({kind} NAME) ...)")
    if len(as_group(top.items[1]).items) != 2:
        raise PddlError(top.line, f"({kind} ...) takes one name")
    parts = {as_group(node).head.lstrip(":"): as_group(node) for node in top.items[2:]}
    whole = top if kind == "domain" else as_group(top.items[1])
    return parts | {kind: whole}


def _conjuncts(node: Word | Group | None) -> Iterator[Group]:
    if node is None:
        return
    group = as_group(node)
    if group.head == "and":
        yield from (as_group(item) for item in group.items[1:])
    elif group.items:
        yield group


def _rest(group: Group | None) -> Sequence[Word | Group]:
    return group.items[1:] if group else ()


def _is_cost(node: Word | Group) -> bool:
    return isinstance(node, Group) and node.head == "="
