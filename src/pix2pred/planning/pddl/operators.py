"""Actions of PDDL as operators of STRIPS, for those who learn from, explain, or export them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from pix2pred.planning.pddl.formulas import TRUE, Equality, Literal, PddlAction, conjuncts
from pix2pred.planning.pddl.syntax import PddlError, Place
from pix2pred.structs import FromDomain, LiftedAtom, Operator, Predicate, Skill, Type, Variable

_SKILL = re.compile(r"^\s*;@ skill (\S+) (\d{1,9}) (.+?)\s*$", re.MULTILINE)

UNEQUAL = Predicate("=/=", (Type("object"), Type("object")), FromDomain())
"""Stands for ``(not (= ?a ?b))`` where only some pairs of parameters exclude each other; problems get its atoms."""

Pair = frozenset[str]
"""The names of two parameters that must be different objects."""


@dataclass(frozen=True, slots=True)
class SkillNote:
    """What a ``;@ skill`` comment tells: how many transitions support the operator, and the skill behind it."""

    support: int
    skill: str
    args: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class StripsOperators:
    """Operators; ``distinct``: parameters of all of them are different objects wherever types let them coincide."""

    operators: tuple[Operator, ...]
    distinct: bool


def skill_notes(text: str) -> dict[str, SkillNote]:
    """The notes in the comments of a domain, by the PDDL form of the action."""
    found = {}
    for form, support, behind in _SKILL.findall(text):
        skill, *args = behind.split()
        found[form] = SkillNote(int(support), skill, tuple(args))
    return found


def strips_operators(
    actions: Sequence[PddlAction],
    types: Mapping[str, Type],
    predicates: Mapping[str, Predicate],
    notes: Mapping[str, SkillNote],
    places: Mapping[str, Place],
) -> StripsOperators | None:
    """The operators that say the same as ``actions``; ``None`` when some action says more than an operator can.

    ``places`` are where the actions stand. Raises ``PddlError`` for a note with arguments that are no parameters.
    """
    operators, unequal = [], []
    for action in actions:
        note = notes.get(action.name) or SkillNote(0, action.name, tuple(p.name for p in action.parameters))
        unknown = set(note.args) - {p.name for p in action.parameters}
        if unknown:
            what = f"its ;@ skill comment names {min(unknown)}, which is no parameter"
            raise PddlError(places[action.name], f"action {action.name}: {what}")
        if any(len(p.types) > 1 for p in action.parameters):
            return None
        variables = {p.name: Variable(p.name, types[p.types[0]]) for p in action.parameters}
        conditions = conjuncts(action.precondition)
        pairs = {frozenset((c.left, c.right)) for c in conditions if isinstance(c, Equality) and not c.positive}
        literals = [c for c in conditions if isinstance(c, Literal) and c.positive]
        plain = all(not e.variables and e.condition == TRUE for e in action.effects)
        used = {t for a in (*literals, *(e.literal for e in action.effects)) for t in a.terms}.union(*pairs)
        if not plain or len(literals) + sum(not isinstance(c, Literal) for c in conditions) != len(conditions):
            return None
        if not used <= set(variables) or any(isinstance(c, Equality) and c.positive for c in conditions):
            return None
        if any(len(p) != 2 for p in pairs) or not all(isinstance(c, Literal | Equality) for c in conditions):
            return None
        operators.append(_operator(action, note, variables, predicates, literals))
        unequal.append(pairs)
    complete = [pairs >= _overlapping(op.parameters) for op, pairs in zip(operators, unequal, strict=True)]
    if not all(complete):
        operators = [_with_inequalities(op, pairs) for op, pairs in zip(operators, unequal, strict=True)]
    return StripsOperators(tuple(operators), all(complete))


def _operator(
    action: PddlAction,
    note: SkillNote,
    variables: Mapping[str, Variable],
    predicates: Mapping[str, Predicate],
    conditions: Iterable[Literal],
) -> Operator:
    def lifted(literals: Iterable[Literal]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(predicates[a.predicate], tuple(variables[t] for t in a.terms)) for a in literals)

    add = lifted(e.literal for e in action.effects if e.literal.positive)
    delete = lifted(e.literal for e in action.effects if not e.literal.positive)
    args = tuple(variables[name] for name in note.args)
    skill = Skill(note.skill, tuple(v.type for v in args))
    pre = lifted(conditions)
    return Operator(action.name, tuple(variables.values()), pre, add, delete - add, skill, args, note.support)


def _with_inequalities(operator: Operator, pairs: set[Pair]) -> Operator:
    by_name = {v.name: v for v in operator.parameters}
    atoms = {LiftedAtom(UNEQUAL, tuple(by_name[n] for n in sorted(pair))) for pair in pairs}
    return replace(operator, preconditions=operator.preconditions | atoms)


def _overlapping(variables: Sequence[Variable]) -> set[Pair]:
    """Pairs of parameters that one object could fill."""
    return {
        frozenset((a.name, b.name))
        for i, a in enumerate(variables)
        for b in variables[i + 1 :]
        if a.type.is_a(b.type) or b.type.is_a(a.type)
    }
