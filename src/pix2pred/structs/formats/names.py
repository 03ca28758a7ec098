"""Declared names and what they stand for; a name that was never declared is an error with a suggestion."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, TypeVar

from pix2pred.structs.objects import Object, Type, Variable
from pix2pred.structs.predicates import Atom, LiftedAtom, Predicate
from pix2pred.structs.skills import Action, Skill
from pix2pred.system.errors import Pix2predError

if TYPE_CHECKING:
    from pix2pred.structs.formats.documents import ObjectDoc  # the checking library is slow to import

T = TypeVar("T")


class UnknownNameError(Pix2predError, ValueError):
    """A name that was never declared; with ``listed`` the message says which there are."""

    def __init__(self, kind: str, name: str, known: Iterable[str], *, listed: bool = False) -> None:
        names = list(known)
        close = difflib.get_close_matches(name, names, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        there = f"; there are {', '.join(sorted(names))}" if listed else ""
        super().__init__(f"{kind} {name!r} {'does not exist' if listed else 'is not declared'}{hint}{there}")


class DeclaredNames:
    """Declared names and the objects they stand for."""

    def __init__(self, types: Sequence[Type], skills: Sequence[Skill], predicates: Sequence[Predicate]) -> None:
        self.types: Mapping[str, Type] = {t.name: t for t in types}
        self.skills: Mapping[str, Skill] = {s.name: s for s in skills}
        self.predicates: Mapping[str, Predicate] = {p.name: p for p in predicates}

    def type(self, name: str) -> Type:
        """The type called ``name``."""
        return look_up("type", name, self.types)

    def skill(self, name: str) -> Skill:
        """The skill called ``name``."""
        return look_up("skill", name, self.skills)

    def predicate(self, name: str) -> Predicate:
        """The predicate called ``name``."""
        return look_up("predicate", name, self.predicates)

    def object(self, name: str, doc: ObjectDoc) -> Object:
        """The object described by ``doc``."""
        return Object(name, self.type(doc.type), doc.descriptor or name)

    def atom(self, name: str, args: Sequence[str], objects: Mapping[str, Object]) -> Atom:
        """The atom ``name(args)``; checks the number and types of the arguments."""
        predicate = self.predicate(name)
        bound = tuple(look_up("object", a, objects) for a in args)
        check_types(f"predicate {name}", predicate.types, bound)
        return Atom(predicate, bound)

    def action(self, name: str, args: Sequence[str], params: Sequence[float], objects: Mapping[str, Object]) -> Action:
        """The action ``name(args)[params]``; checks arguments and the number of parameters."""
        skill = self.skill(name)
        bound = tuple(look_up("object", a, objects) for a in args)
        check_types(f"skill {name}", skill.types, bound)
        if len(params) != skill.dimension:
            raise ValueError(f"skill {name} takes {skill.dimension} continuous parameters, found {len(params)}")
        return Action(skill, bound, tuple(params))

    def lifted(self, parts: Sequence[str], variables: Mapping[str, Variable]) -> LiftedAtom:
        """The lifted atom written as ``[name, variable, ...]``; checks the number and types of the variables."""
        predicate = self.predicate(parts[0])
        bound = tuple(look_up("variable", v, variables) for v in parts[1:])
        check_types(f"predicate {predicate}", predicate.types, bound)
        return LiftedAtom(predicate, bound)


def look_up(kind: str, name: str, table: Mapping[str, T]) -> T:
    """What ``table`` has under ``name``. Raises ``UnknownNameError`` that calls it a ``kind``."""
    if name not in table:
        raise UnknownNameError(kind, name, table)
    return table[name]


def check_types(what: str, types: Sequence[Type], bound: Sequence[Object | Variable]) -> None:
    """Raise ``ValueError`` unless ``bound`` has one argument of each of ``types``, in their order."""
    if len(types) != len(bound):
        raise ValueError(f"{what} takes {len(types)} arguments, found {len(bound)}")
    for wanted, found in zip(types, bound, strict=True):
        if not found.type.is_a(wanted):
            raise ValueError(f"{what}: {found.name} is a {found.type.name}, not a {wanted.name}")


def check_distinct(kind: str, names: Sequence[str]) -> None:
    """Raise ``ValueError`` when a name of a ``kind`` of thing is there twice."""
    if repeated := {n for n in names if names.count(n) > 1}:
        raise ValueError(f"{kind} {sorted(repeated)[0]!r} is declared twice")
