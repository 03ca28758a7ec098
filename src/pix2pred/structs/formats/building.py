"""From the documents of a file to the nouns they describe; whatever does not fit raises ``ValueError`` in words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from pix2pred.structs.demos import Vocabulary
from pix2pred.structs.expressions import check_expression, parse_expression
from pix2pred.structs.formats.documents import OperatorDoc, PredicateDoc, SkillDoc, TypeDoc, VocabularyDoc
from pix2pred.structs.formats.names import DeclaredNames, UnknownNameError, check_distinct, check_types, look_up
from pix2pred.structs.objects import Type, Variable
from pix2pred.structs.operators import Operator
from pix2pred.structs.predicates import (
    FromDomain,
    FromFeatures,
    FromHuman,
    FromSkills,
    FromVLM,
    LiftedAtom,
    Predicate,
    SkillTrigger,
    Source,
)
from pix2pred.structs.skills import Skill

MAX_ANCESTORS = 50
"""Longer chains of parent types are refused: no domain has them, and they would exhaust the stack."""


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
            parent = built[doc.parent] if doc.parent else None
            built.setdefault(ancestor, Type(ancestor, doc.features, parent, doc.description, doc.measures))
    return tuple(built[name] for name in table)


def _lineage(name: str, table: Mapping[str, TypeDoc]) -> list[str]:
    """``name``, its parent, and so on to a type without a parent."""
    line = [name]
    while parent := look_up("type", line[-1], table).parent:
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
    return Skill(doc.name, tuple(look_up("type", t, types) for t in doc.types), doc.low, doc.high, doc.description)


def build_predicate(doc: PredicateDoc, types: Mapping[str, Type]) -> Predicate:
    """The predicate described by ``doc``."""
    argument_types = tuple(look_up("type", t, types) for t in doc.types)
    return Predicate(doc.name, argument_types, _build_source(doc, types), doc.description)


@dataclass(frozen=True, slots=True)
class TriggerFault:
    """A trigger of a predicate that cannot work: where in the predicate's document, which skill, and why."""

    where: tuple[str | int, ...]
    skill: str
    message: str


def trigger_faults(predicate: Predicate, skills: Mapping[str, Skill]) -> Iterator[TriggerFault]:
    """What is wrong with the triggers of ``predicate``: each has to name a skill and to fit its arguments."""
    source = predicate.source
    if isinstance(source, FromSkills):
        for key, triggers in (("set_by", source.set_by), ("cleared_by", source.cleared_by)):
            for i, trigger in enumerate(triggers):
                for where, message in _misfits(predicate, trigger, skills):
                    yield TriggerFault((key, i, *where), trigger.skill, message)


def _misfits(
    predicate: Predicate, trigger: SkillTrigger, skills: Mapping[str, Skill]
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    skill = skills.get(trigger.skill)
    if skill is None:
        yield ("skill",), str(UnknownNameError("skill", trigger.skill, skills))
    elif len(trigger.args) != predicate.arity:
        yield ("args",), f"predicate {predicate} takes {predicate.arity} arguments, args has {len(trigger.args)}"
    else:
        for i, (wanted, position) in enumerate(zip(predicate.types, trigger.args, strict=True)):
            if not 0 <= position < len(skill.types):
                yield ("args", i), f"skill {skill} has no argument {position}; positions count from 0"
            elif not (skill.types[position].is_a(wanted) or wanted.is_a(skill.types[position])):
                yield ("args", i), f"argument {position} of skill {skill} is a {skill.types[position]}, not a {wanted}"


def check_triggers(predicate: Predicate, skills: Iterable[Skill]) -> None:
    """Raise ``ValueError`` when a skill named by the source of ``predicate`` does not exist or does not fit it."""
    for fault in trigger_faults(predicate, {s.name: s for s in skills}):
        raise ValueError(f"predicate {predicate}: {fault.message}")


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
            return FromVLM(phrase, doc.also, doc.opposite, doc.changes)
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


def build_operator(doc: OperatorDoc, names: DeclaredNames) -> Operator:
    """The operator described by ``doc``. Raises ``ValueError`` naming the operator."""
    try:
        return _build_operator(doc, names)
    except ValueError as error:
        raise ValueError(f"operator {doc.name}: {error}") from error


def _build_operator(doc: OperatorDoc, names: DeclaredNames) -> Operator:
    check_distinct("parameter", [name for name, _ in doc.parameters])
    variables = {name: Variable(name, names.type(type_name)) for name, type_name in doc.parameters}
    skill = names.skill(doc.skill[0])
    skill_args = tuple(look_up("variable", v, variables) for v in doc.skill[1:])
    check_types(f"skill {skill.name}", skill.types, skill_args)

    def atoms(group: Iterable[Sequence[str]]) -> frozenset[LiftedAtom]:
        return frozenset(names.lifted(parts, variables) for parts in group)

    return Operator(
        doc.name, tuple(variables.values()), atoms(doc.preconditions), atoms(doc.add), atoms(doc.delete),
        skill, skill_args, doc.support,
    )  # fmt: skip


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
