"""Names for PDDL: legal, different, readable by others, and reversible."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace

from pix2pred.planning.pddl.parts import RESERVED
from pix2pred.structs import LiftedAtom, Operator, Variable, WorldModel

_ONE_SPACE = "name"
_SHARED = {"type", "predicate", "action", "object"}


class PddlNames:
    """Original names and their PDDL forms.

    Types, predicates, actions and objects share no form: some readers refuse an object that is called like its type.
    """

    def __init__(self) -> None:
        self._forms: dict[tuple[str, str], str] = {}
        self._taken: dict[str, set[str]] = {}

    def form(self, kind: str, name: str) -> str:
        """The PDDL form of ``name``: lower case, legal characters, no word of the language, different from others."""
        if (kind, name) not in self._forms:
            space = _ONE_SPACE if kind in _SHARED else kind
            taken = self._taken.setdefault(space, {"object", *RESERVED})
            base = _legal(name)
            form, number = base, 2
            while form in taken:
                form, number = f"{base}-{number}", number + 1
            taken.add(form)
            self._forms[kind, name] = form
        return self._forms[kind, name]

    def changed(self) -> list[tuple[str, str, str]]:
        """(kind, PDDL form, original name) wherever the two differ, sorted."""
        return sorted((kind, form, name) for (kind, name), form in self._forms.items() if form != name)


def _legal(name: str) -> str:
    """``name`` in lower case with the characters that PDDL allows, beginning with a letter."""
    base = re.sub(r"[^a-z0-9_]+", "-", name.lower()).strip("-_") or "x"
    return base if base[0].isalpha() else f"x-{base}"


def described(model: WorldModel) -> WorldModel:
    """``model`` with operators called after skill and effects (``pick-patty``), parameters after types (``?patty``).

    Of the effects those are named that not all operators with this skill and these types have.
    """
    first_types = {op.skill.types[0].name if op.skill.types else "" for op in model.operators}
    agents = first_types if len(first_types) == 1 else set()
    firsts = {op: _described_by_skill(op, agents) for op in model.operators}
    effects = {
        op: {a.predicate.name for a in op.add} or {f"not-{a.predicate.name}" for a in op.delete} for op in firsts
    }
    shared = {
        first: set.intersection(*(effects[op] for op in firsts if firsts[op] == first)) for first in firsts.values()
    }
    names: list[str] = []
    for op in model.operators:
        base = name = _legal("-".join((firsts[op], *sorted(effects[op] - shared[firsts[op]]))))
        number = 2
        while name in names:
            name, number = f"{base}-v{number}", number + 1
        names.append(name)
    operators = tuple(_with_names(op, name) for op, name in zip(model.operators, names, strict=True))
    return replace(model, operators=operators)


def arguments_first(op: Operator) -> tuple[Variable, ...]:
    """The parameters of ``op`` with the arguments of its skill before the others."""
    return tuple(dict.fromkeys((*op.skill_args, *op.parameters)))


def _described_by_skill(op: Operator, agents: set[str]) -> str:
    """The skill and the types of its arguments, but for who acts: the first argument, if all skills agree on it."""
    return "-".join((op.skill.name, *(t.name for t in op.skill.types if t.name not in agents)))


def _with_names(op: Operator, name: str) -> Operator:
    """``op`` under another name, the arguments of its skill first among its parameters.

    They are called after their types; a second one of a type gets a number.
    """
    count: Counter[str] = Counter()
    new: dict[Variable, Variable] = {}
    for v in arguments_first(op):
        base = _legal(v.type.name)
        count[base] += 1
        new[v] = Variable(f"?{base}" if count[base] == 1 else f"?{base}-{count[base]}", v.type)

    def renamed(atoms: frozenset[LiftedAtom]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(a.predicate, tuple(new[v] for v in a.variables)) for a in atoms)

    return replace(
        op,
        name=name,
        parameters=tuple(new.values()),
        preconditions=renamed(op.preconditions),
        add=renamed(op.add),
        delete=renamed(op.delete),
        skill_args=tuple(new[v] for v in op.skill_args),
    )
