"""How the nouns are written in files: one pydantic model per noun, shared by every format.

The models check each entry; ``Names`` resolves the names in them to objects and raises ``UnknownNameError`` with a
suggestion where one does not exist.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from pix2pred.structs.demos import Vocabulary
from pix2pred.structs.expressions import check_expression, parse_expression
from pix2pred.structs.objects import Object, Type, Variable
from pix2pred.structs.operators import Operator
from pix2pred.structs.predicates import (
    Atom,
    FromDomain,
    FromFeatures,
    FromHuman,
    FromSkills,
    FromVLM,
    LiftedAtom,
    Predicate,
    SkillTrigger,
    Source,
    SourceName,
    source_name,
)
from pix2pred.structs.skills import Action, Skill
from pix2pred.system.errors import Pix2predError

T = TypeVar("T")

Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_\-]*$", max_length=100)]
"""Names of types, objects and skills: a letter, then letters, digits, ``_`` or ``-``."""

PredicateName = Annotated[str, StringConstraints(pattern=r"^[^\s(),;\"']+$", max_length=300)]
"""Predicate names also allow the brackets and signs of feature predicates."""


Applied = Annotated[tuple[str, ...], Field(min_length=1)]
"""A predicate or skill and its variables, ``[name, variable, ...]``."""

MAX_ANCESTORS = 50
"""Longer chains of parent types are refused: no domain has them, and they would exhaust the stack."""


class UnknownNameError(Pix2predError, ValueError):
    """A name that was never declared."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        close = difflib.get_close_matches(name, list(known), n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        super().__init__(f"{kind} {name!r} is not declared{hint}")


class Document(BaseModel):
    """Base of everything read from a file: unknown keys are errors, values never change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class TypeDoc(Document):
    """A type: its name, its parent's name and the names of its numeric features."""

    name: Name
    parent: Name | None = None
    features: tuple[Name, ...] = ()


class ObjectDoc(Document):
    """An object: its type and the phrase that picks it out in the pictures (default: its name)."""

    type: Name
    descriptor: str = ""


class SkillDoc(Document):
    """A skill: argument types, and lower and upper bounds of its continuous parameters."""

    name: Name
    types: tuple[Name, ...]
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()


class TriggerDoc(Document):
    """A skill that changes an atom; ``args[i]`` is the position of the skill argument bound to argument i."""

    skill: Name
    args: tuple[int, ...]


class PredicateDoc(Document):
    """A predicate with its argument types and the source of its values."""

    name: PredicateName
    types: tuple[Name, ...]
    source: SourceName = "domain"
    phrase: str | None = Field(None, description="source vlm: the word used in queries; default: the name")
    expression: str | None = Field(None, description="source features: e.g. (<= robot.fingers 0.5)")
    set_by: tuple[TriggerDoc, ...] = Field((), description="source skills: skills that make the atom true")
    cleared_by: tuple[TriggerDoc, ...] = Field((), description="source skills: skills that make it false")
    initially: bool = Field(False, description="source skills: the value before the first skill")


class OperatorDoc(Document):
    """An operator; atoms are lists of a predicate name and variable names."""

    name: str
    parameters: tuple[tuple[str, Name], ...]
    preconditions: tuple[Applied, ...]
    add: tuple[Applied, ...]
    delete: tuple[Applied, ...]
    skill: Applied
    support: int = Field(0, ge=0)


class Names:
    """Declared names and the objects they stand for."""

    def __init__(self, types: Sequence[Type], skills: Sequence[Skill], predicates: Sequence[Predicate]) -> None:
        self.types: Mapping[str, Type] = {t.name: t for t in types}
        self.skills: Mapping[str, Skill] = {s.name: s for s in skills}
        self.predicates: Mapping[str, Predicate] = {p.name: p for p in predicates}

    def type(self, name: str) -> Type:
        """The type called ``name``."""
        return _look_up("type", name, self.types)

    def skill(self, name: str) -> Skill:
        """The skill called ``name``."""
        return _look_up("skill", name, self.skills)

    def predicate(self, name: str) -> Predicate:
        """The predicate called ``name``."""
        return _look_up("predicate", name, self.predicates)

    def object(self, name: str, doc: ObjectDoc) -> Object:
        """The object described by ``doc``."""
        return Object(name, self.type(doc.type), doc.descriptor or name)

    def atom(self, name: str, args: Sequence[str], objects: Mapping[str, Object]) -> Atom:
        """The atom ``name(args)``; checks the number and types of the arguments."""
        predicate = self.predicate(name)
        bound = tuple(_look_up("object", a, objects) for a in args)
        _check_types(f"predicate {name}", predicate.types, bound)
        return Atom(predicate, bound)

    def action(self, name: str, args: Sequence[str], params: Sequence[float], objects: Mapping[str, Object]) -> Action:
        """The action ``name(args)[params]``; checks arguments and the number of parameters."""
        skill = self.skill(name)
        bound = tuple(_look_up("object", a, objects) for a in args)
        _check_types(f"skill {name}", skill.types, bound)
        if len(params) != skill.dimension:
            raise ValueError(f"skill {name} takes {skill.dimension} continuous parameters, found {len(params)}")
        return Action(skill, bound, tuple(params))

    def lifted(self, parts: Sequence[str], variables: Mapping[str, Variable]) -> LiftedAtom:
        """The lifted atom written as ``[name, variable, ...]``; checks the number and types of the variables."""
        predicate = self.predicate(parts[0])
        bound = tuple(_look_up("variable", v, variables) for v in parts[1:])
        _check_types(f"predicate {predicate}", predicate.types, bound)
        return LiftedAtom(predicate, bound)


def _look_up(kind: str, name: str, table: Mapping[str, T]) -> T:
    if name not in table:
        raise UnknownNameError(kind, name, table)
    return table[name]


def _check_types(what: str, types: Sequence[Type], bound: Sequence[Object | Variable]) -> None:
    if len(types) != len(bound):
        raise ValueError(f"{what} takes {len(types)} arguments, found {len(bound)}")
    for wanted, found in zip(types, bound, strict=True):
        if not found.type.is_a(wanted):
            raise ValueError(f"{what}: {found.name} is a {found.type.name}, not a {wanted.name}")


def check_distinct(kind: str, names: Sequence[str]) -> None:
    """Raise ``ValueError`` when a name of a ``kind`` of thing is there twice."""
    if repeated := {n for n in names if names.count(n) > 1}:
        raise ValueError(f"{kind} {sorted(repeated)[0]!r} is declared twice")


def build_types(docs: Iterable[TypeDoc]) -> tuple[Type, ...]:
    """Types in the order given, parents resolved whatever their order.

    Raises ``ValueError`` on repeats, cycles, unknown parents and more than ``MAX_ANCESTORS``.
    """
    table: dict[str, TypeDoc] = {}
    for doc in docs:
        if doc.name in table:
            raise ValueError(f"type {doc.name!r} is declared twice")
        table[doc.name] = doc
    built: dict[str, Type] = {}
    for name in table:
        for ancestor in reversed(_lineage(name, table)):
            doc = table[ancestor]
            built.setdefault(ancestor, Type(ancestor, doc.features, built[doc.parent] if doc.parent else None))
    return tuple(built[name] for name in table)


def _lineage(name: str, table: Mapping[str, TypeDoc]) -> list[str]:
    """``name``, its parent, and so on to a type without a parent."""
    line = [name]
    while parent := _look_up("type", line[-1], table).parent:
        if parent in line:
            raise ValueError(f"type {parent!r} is its own ancestor: {' > '.join((*line, parent))}")
        if len(line) > MAX_ANCESTORS:
            raise ValueError(f"type {name!r} has more than {MAX_ANCESTORS} ancestors")
        line.append(parent)
    return line


def build_skill(doc: SkillDoc, types: Mapping[str, Type]) -> Skill:
    """The skill described by ``doc``."""
    if len(doc.low) != len(doc.high) or any(lo > hi for lo, hi in zip(doc.low, doc.high, strict=True)):
        raise ValueError(f"skill {doc.name}: low and high must have equal lengths and low <= high")
    if not all(math.isfinite(bound) for bound in (*doc.low, *doc.high)):
        raise ValueError(f"skill {doc.name}: a bound is not a number or not finite")
    return Skill(doc.name, tuple(_look_up("type", t, types) for t in doc.types), doc.low, doc.high)


def build_predicate(doc: PredicateDoc, types: Mapping[str, Type]) -> Predicate:
    """The predicate described by ``doc``."""
    return Predicate(doc.name, tuple(_look_up("type", t, types) for t in doc.types), _build_source(doc, types))


def check_triggers(predicate: Predicate, skills: Iterable[Skill]) -> None:
    """Raise ``ValueError`` when a skill named by the source of ``predicate`` does not exist or does not fit it."""
    if not isinstance(predicate.source, FromSkills):
        return
    table = {s.name: s for s in skills}
    for trigger in (*predicate.source.set_by, *predicate.source.cleared_by):
        skill = _look_up("skill", trigger.skill, table)
        if len(trigger.args) != predicate.arity:
            what = f"predicate {predicate} takes {predicate.arity} arguments"
            raise ValueError(f"{what}, its trigger {skill} binds {len(trigger.args)}")
        for wanted, position in zip(predicate.types, trigger.args, strict=True):
            if not 0 <= position < len(skill.types):
                raise ValueError(f"predicate {predicate}: skill {skill} has no argument {position}")
            if not (skill.types[position].is_a(wanted) or wanted.is_a(skill.types[position])):
                raise ValueError(f"predicate {predicate}: argument {position} of skill {skill} is not a {wanted}")


def _build_source(doc: PredicateDoc, types: Mapping[str, Type]) -> Source:
    match doc.source:
        case "domain":
            return FromDomain()
        case "human":
            return FromHuman()
        case "vlm":
            phrase = doc.phrase or doc.name
            if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", phrase):
                raise ValueError(
                    f"predicate {doc.name}: the phrase {phrase!r} must be one word of letters, digits and _"
                )
            return FromVLM(phrase)
        case "features":
            if doc.expression is None:
                raise ValueError(f"predicate {doc.name}: source features needs an expression")
            check_expression(doc.name, parse_expression(doc.expression), doc.types, types)
            return FromFeatures(doc.expression)
        case "skills":
            return FromSkills(
                tuple(SkillTrigger(t.skill, t.args) for t in doc.set_by),
                tuple(SkillTrigger(t.skill, t.args) for t in doc.cleared_by),
                doc.initially,
            )


def type_doc(t: Type) -> dict[str, Any]:
    """``t`` as written in files."""
    doc: dict[str, Any] = {"name": t.name}
    if t.parent:
        doc["parent"] = t.parent.name
    if t.features:
        doc["features"] = list(t.features)
    return doc


def skill_doc(skill: Skill) -> dict[str, Any]:
    """``skill`` as written in files."""
    doc: dict[str, Any] = {"name": skill.name, "types": [t.name for t in skill.types]}
    if skill.dimension:
        doc |= {"low": list(skill.low), "high": list(skill.high)}
    return doc


def predicate_doc(predicate: Predicate) -> dict[str, Any]:
    """``predicate`` as written in files."""
    doc: dict[str, Any] = {
        "name": predicate.name,
        "types": [t.name for t in predicate.types],
        "source": source_name(predicate.source),
    }
    match predicate.source:
        case FromVLM(phrase):
            doc["phrase"] = phrase
        case FromFeatures(expression):
            doc["expression"] = expression
        case FromSkills(set_by, cleared_by, initially):
            doc["set_by"] = [{"skill": t.skill, "args": list(t.args)} for t in set_by]
            doc["cleared_by"] = [{"skill": t.skill, "args": list(t.args)} for t in cleared_by]
            doc["initially"] = initially
    return doc


def operator_doc(op: Operator) -> dict[str, Any]:
    """``op`` as written in files."""

    def atoms(group: Iterable[LiftedAtom]) -> list[list[str]]:
        return [[a.predicate.name, *(v.name for v in a.variables)] for a in sorted(group)]

    return {
        "name": op.name,
        "parameters": [[v.name, v.type.name] for v in op.parameters],
        "preconditions": atoms(op.preconditions),
        "add": atoms(op.add),
        "delete": atoms(op.delete),
        "skill": [op.skill.name, *(v.name for v in op.skill_args)],
        "support": op.support,
    }


def build_operator(doc: OperatorDoc, names: Names) -> Operator:
    """The operator described by ``doc``. Raises ``ValueError`` naming the operator."""
    try:
        return _build_operator(doc, names)
    except ValueError as error:
        raise ValueError(f"operator {doc.name}: {error}") from error


def _build_operator(doc: OperatorDoc, names: Names) -> Operator:
    check_distinct("parameter", [name for name, _ in doc.parameters])
    variables = {name: Variable(name, names.type(type_name)) for name, type_name in doc.parameters}
    skill = names.skill(doc.skill[0])
    skill_args = tuple(_look_up("variable", v, variables) for v in doc.skill[1:])
    _check_types(f"skill {skill.name}", skill.types, skill_args)

    def atoms(group: Iterable[Sequence[str]]) -> frozenset[LiftedAtom]:
        return frozenset(names.lifted(parts, variables) for parts in group)

    return Operator(
        doc.name, tuple(variables.values()), atoms(doc.preconditions), atoms(doc.add), atoms(doc.delete),
        skill, skill_args, doc.support,
    )  # fmt: skip


class VocabularyDoc(Document):
    """Types, skills and initial predicates."""

    name: str
    types: tuple[TypeDoc, ...]
    skills: tuple[SkillDoc, ...]
    predicates: tuple[PredicateDoc, ...]


def vocabulary_doc(vocabulary: Vocabulary) -> dict[str, Any]:
    """``vocabulary`` as written in files."""
    return {
        "name": vocabulary.name,
        "types": [type_doc(t) for t in vocabulary.types],
        "skills": [skill_doc(s) for s in vocabulary.skills],
        "predicates": [predicate_doc(p) for p in vocabulary.initial],
    }


def build_vocabulary(doc: VocabularyDoc) -> Vocabulary:
    """The vocabulary described by ``doc``. Raises ``ValueError`` on repeated or unknown names."""
    for entry in doc.types:
        check_distinct(f"type {entry.name}: feature", entry.features)
    check_distinct("skill", [s.name for s in doc.skills])
    check_distinct("predicate", [p.name for p in doc.predicates])
    types = build_types(doc.types)
    table = {t.name: t for t in types}
    skills = tuple(build_skill(s, table) for s in doc.skills)
    initial = tuple(build_predicate(p, table) for p in doc.predicates)
    for predicate in initial:
        check_triggers(predicate, skills)
    return Vocabulary(doc.name, types, skills, initial)
