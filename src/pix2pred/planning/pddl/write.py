"""World models and tasks as typed STRIPS PDDL, with a reversible table of names.

PDDL ignores case and allows few characters, so names are rewritten; the table stands in comments (``;@ name``), as do
the skills behind the actions (``;@ skill``), and ``pddl_read`` gives the original names back.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from pix2pred.structs import (
    AbstractState,
    Atom,
    GroundOperator,
    LiftedAtom,
    Object,
    Operator,
    Predicate,
    Type,
    Variable,
    WorldModel,
)


class PddlNames:
    """Original names and their PDDL forms, one table per kind (type, predicate, action, object)."""

    def __init__(self) -> None:
        self._forms: dict[tuple[str, str], str] = {}
        self._taken: dict[str, set[str]] = {}

    def form(self, kind: str, name: str) -> str:
        """The PDDL form of ``name``: lower case, legal characters, different from all others of its kind."""
        if (kind, name) not in self._forms:
            taken = self._taken.setdefault(kind, {"object"} if kind == "type" else set())
            base = re.sub(r"[^a-z0-9_]+", "-", name.lower()).strip("-_") or "x"
            if not base[0].isalpha():
                base = f"x-{base}"
            form, number = base, 2
            while form in taken:
                form, number = f"{base}-{number}", number + 1
            taken.add(form)
            self._forms[kind, name] = form
        return self._forms[kind, name]

    def changed(self) -> list[tuple[str, str, str]]:
        """(kind, PDDL form, original name) wherever the two differ, sorted."""
        return sorted((kind, form, name) for (kind, name), form in self._forms.items() if form != name)


def write_domain(model: WorldModel, names: PddlNames | None = None) -> str:
    """The PDDL domain of ``model``; every action excludes that two of its parameters are one object."""
    names = names or PddlNames()
    types = "\n".join(_type_line(t, names) for t in model.vocabulary.types if t.name != "object" or t.parent)
    predicates = "\n".join(_predicate_line(p, names) for p in model.predicates)
    actions = "\n".join(_action(op, names) for op in model.operators)
    table = "".join(f";@ name {kind} {form} {name}\n" for kind, form, name in names.changed())
    table += "".join(f"; invariant: {invariant}\n" for invariant in model.invariants)
    return (
        f"{table}(define (domain {names.form('domain', model.vocabulary.name)})\n"
        " (:requirements :strips :typing :equality :negative-preconditions)\n"
        f" (:types\n{types}\n )\n (:predicates\n{predicates}\n )\n{actions}\n)\n"
    )


def write_problem(
    model: WorldModel, name: str, objects: Iterable[Object], initial: AbstractState, goal: Iterable[Atom]
) -> str:
    """The PDDL problem of one task of ``model``, for the domain that ``write_domain`` gives."""
    names = PddlNames()
    write_domain(model, names)
    things = "\n".join(f"   {names.form('object', o.name)} - {_type_form(o.type, names)}" for o in sorted(objects))
    facts = "\n".join(f"   {_atom(a.predicate, [o.name for o in a.objects], names)}" for a in sorted(initial))
    wanted = " ".join(_atom(a.predicate, [o.name for o in a.objects], names) for a in sorted(goal))
    table = "".join(f";@ name {kind} {form} {original}\n" for kind, form, original in names.changed())
    return (
        f"{table}(define (problem {names.form('problem', name)})\n"
        f" (:domain {names.form('domain', model.vocabulary.name)})\n"
        f" (:objects\n{things}\n )\n (:init\n{facts}\n )\n (:goal (and {wanted}))\n)\n"
    )


def write_plan(model: WorldModel, objects: Iterable[Object], plan: Iterable[GroundOperator]) -> str:
    """A plan as planning competitions write it, one ``(action object ...)`` a line, with the names of the files above.

    ``objects`` are all of the task, as given to ``write_problem``.
    """
    names = PddlNames()
    write_domain(model, names)
    for o in sorted(objects):
        names.form("object", o.name)
    return "".join(
        f"({' '.join((names.form('action', s.operator.name), *(names.form('object', o.name) for o in s.objects)))})\n"
        for s in plan
    )


def _type_form(t: Type, names: PddlNames) -> str:
    return "object" if t.name == "object" and t.parent is None else names.form("type", t.name)


def _type_line(t: Type, names: PddlNames) -> str:
    return f"   {_type_form(t, names)} - {_type_form(t.parent, names) if t.parent else 'object'}"


def _predicate_line(p: Predicate, names: PddlNames) -> str:
    arguments = " ".join(f"?a{i} - {_type_form(t, names)}" for i, t in enumerate(p.types))
    return f"   ({' '.join(filter(None, (names.form('predicate', p.name), arguments)))})"


def _atom(predicate: Predicate, args: Sequence[str], names: PddlNames) -> str:
    shown = [a if a.startswith("?") else names.form("object", a) for a in args]
    return f"({' '.join((names.form('predicate', predicate.name), *shown))})"


def _action(op: Operator, names: PddlNames) -> str:
    def lifted(atoms: Iterable[LiftedAtom]) -> list[str]:
        return [_atom(a.predicate, [v.name for v in a.variables], names) for a in sorted(atoms)]

    form = names.form("action", op.name)
    parameters = " ".join(f"{v.name} - {_type_form(v.type, names)}" for v in op.parameters)
    pre = [*lifted(op.preconditions), *(f"(not (= {a} {b}))" for a, b in _may_coincide(op.parameters))]
    effects = [*lifted(op.add), *(f"(not {a})" for a in lifted(op.delete))]
    skill = " ".join((op.skill.name, *(v.name for v in op.skill_args)))
    return (
        f" ;@ skill {form} {op.support} {skill}\n"
        f" (:action {form}\n  :parameters ({parameters})\n"
        f"  :precondition (and {' '.join(pre)})\n  :effect (and {' '.join(effects)}))"
    )


def _may_coincide(parameters: Sequence[Variable]) -> list[tuple[Variable, Variable]]:
    """Pairs of parameters that one object could fill."""
    return [
        (a, b)
        for i, a in enumerate(parameters)
        for b in parameters[i + 1 :]
        if a.type.is_a(b.type) or b.type.is_a(a.type)
    ]
