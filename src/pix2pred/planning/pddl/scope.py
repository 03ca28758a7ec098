"""What the names of a PDDL definition mean: types, objects, predicates, functions, and how they fit together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from pix2pred.planning.pddl.formulas import TypedName
from pix2pred.planning.pddl.syntax import Group, PddlError, TypedWord, Word, as_word
from pix2pred.structs import Type

T = TypeVar("T")
MAX_TYPE_DEPTH = 100
CONNECTIVES = frozenset({"and", "or", "not", "imply", "forall", "exists", "when", "="})


@dataclass(slots=True)
class Scope:
    """Names that are declared, by their original names; ``table`` gives those where the PDDL form differs."""

    table: Mapping[tuple[str, str], str]
    types: dict[str, Type] = field(default_factory=dict)
    objects: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """Types of every constant and object."""
    predicates: dict[str, tuple[TypedName, ...]] = field(default_factory=dict)
    functions: dict[str, tuple[TypedName, ...]] = field(default_factory=dict)

    def original(self, kind: str, form: str) -> str:
        """The name that ``form`` stands for."""
        return self.table.get((kind, form), form)

    def look_up(self, known: Mapping[str, T], kind: str, word: Word) -> T:
        """What ``word`` names. Raises ``PddlError``."""
        name = self.original(kind, word.text)
        if name not in known and word.text in CONNECTIVES:
            raise PddlError(word.at, f"({word.text} ...) cannot stand here, where {kind} names are due")
        if name not in known:
            raise PddlError(word.at, f"{kind} {word.text} is not declared")
        return known[name]

    def typed(self, word: TypedWord, kind: str = "variable") -> TypedName:
        """A declared name with the names of its types. Raises ``PddlError``."""
        types = tuple(self.look_up(self.types, "type", t).name for t in word.types)
        name = word.name.text if kind == "variable" else self.original(kind, word.name.text)
        return TypedName(name, types)

    def is_a(self, types: Sequence[str], wanted: Sequence[str]) -> bool:
        """Whether a thing of one of ``types`` is of one of the ``wanted`` types whichever it is."""
        return all(any(self.types[t].is_a(self.types[w]) for w in wanted) for t in types)

    def may_be_a(self, types: Sequence[str], wanted: Sequence[str]) -> bool:
        """Whether a thing of one of ``types`` can be of one of the ``wanted`` types."""
        return any(
            self.types[t].is_a(self.types[w]) or self.types[w].is_a(self.types[t]) for t in types for w in wanted
        )

    def arguments(
        self, group: Group, name: str, wanted: Sequence[TypedName], variables: Mapping[str, TypedName]
    ) -> tuple[str, ...]:
        """The terms behind the head of ``group``, fitting in number and type. Raises ``PddlError``."""
        given = [self.term(as_word(item), variables) for item in group.items[1:]]
        if len(given) != len(wanted):
            raise PddlError(group.at, f"{name} takes {len(wanted)} arguments, found {len(given)}")
        for term, parameter in zip(given, wanted, strict=True):
            if not self.may_be_a(term.types, parameter.types):
                found, due = " or ".join(term.types), " or ".join(parameter.types)
                raise PddlError(group.at, f"{name}: a {found} is given where a {due} is due")
        return tuple(term.name for term in given)

    def term(self, word: Word, variables: Mapping[str, TypedName]) -> TypedName:
        """The variable or object that ``word`` names. Raises ``PddlError``."""
        if word.text.startswith("?"):
            if word.text not in variables:
                raise PddlError(word.at, f"{word.text} is no variable here")
            return variables[word.text]
        return TypedName(self.original("object", word.text), self.look_up(self.objects, "object", word))


def read_types(words: Sequence[TypedWord], scope: Scope) -> None:
    """Enter the types of ``words`` and their parents into ``scope``.

    A parent that is declared nowhere is a type below ``object``. A type may be declared again when that says nothing
    else; of two parents of which one is above the other, the lower one counts. Raises ``PddlError``.
    """
    parents: dict[str, list[Word]] = {}
    for typed in words:
        if len(typed.types) > 1:
            raise PddlError(typed.name.at, f"type {typed.name.text} has several parents, which is not supported")
        if typed.name.text != "object":
            parents.setdefault(typed.name.text, []).append(typed.types[0])
    for word in [w for ws in parents.values() for w in ws]:
        if word.text != "object":
            parents.setdefault(word.text, [Word("object", word.at)])
    depth = {"object": 0}
    scope.types["object"] = Type("object")

    def build(name: str, below: tuple[str, ...]) -> None:
        at = parents[name][0].at
        if len(below) > MAX_TYPE_DEPTH:
            raise PddlError(at, f"types are nested more than {MAX_TYPE_DEPTH} deep")
        if name in below:
            raise PddlError(at, f"type {name} is its own ancestor")
        found: list[tuple[int, str]] = []
        for parent in parents[name]:
            if parent.text not in depth:
                build(parent.text, (*below, name))
            found.append((depth[parent.text], parent.text))
        level, lowest = max(found)
        chosen = scope.types[scope.original("type", lowest)]
        for _, other in found:
            if not chosen.is_a(scope.types[scope.original("type", other)]):
                raise PddlError(at, f"type {name} is declared twice, below {other} and below {lowest}")
        depth[name] = level + 1
        if depth[name] > MAX_TYPE_DEPTH:
            raise PddlError(at, f"types are nested more than {MAX_TYPE_DEPTH} deep")
        original = scope.original("type", name)
        scope.types[original] = Type(original, parent=chosen)

    for name in parents:
        if name not in depth:
            build(name, ())
