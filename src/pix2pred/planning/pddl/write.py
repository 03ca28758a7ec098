"""World models and tasks as typed STRIPS PDDL, with a reversible table of names.

PDDL ignores case and allows few characters, so names are rewritten; the table stands in comments (``;@ name``), as do
the skills behind the actions (``;@ skill``). Reading a file gives the original names of everything but actions back.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pix2pred.planning.pddl.names import PddlNames, arguments_first, described
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
from pix2pred.structs.goals.opposites import contrary, is_denial


def write_domain(model: WorldModel) -> str:
    """The PDDL domain of ``model``; every action excludes that two of its parameters are one object."""
    return _domain(described(model), PddlNames())


def _domain(model: WorldModel, names: PddlNames) -> str:
    name = names.form("domain", model.vocabulary.name)
    types = "\n".join(_type_line(t, names) for t in model.vocabulary.types if t.name != "object" or t.parent)
    predicates = "\n".join(_predicate_line(p, names) for p in model.predicates)
    actions = "\n".join(_action(op, names) for op in model.operators)
    table = "".join(f";@ name {kind} {form} {name}\n" for kind, form, name in names.changed())
    table += "".join(f"; invariant: {invariant}\n" for invariant in model.invariants)
    return (
        f"{table}(define (domain {name})\n"
        " (:requirements :strips :typing :equality :negative-preconditions)\n"
        f" (:types\n{types}\n )\n (:predicates\n{predicates}\n )\n{actions}\n)\n"
    )


def write_problem(
    model: WorldModel,
    name: str,
    objects: Iterable[Object],
    initial: AbstractState,
    *goals: Iterable[Atom],
) -> str:
    """The PDDL problem of one task of ``model``, for the domain that ``write_domain`` gives.

    Of several ``goals`` one is to be reached.
    """
    names = _names_of_domain(described(model))
    things = "\n".join(f"   {names.form('object', o.name)} - {_type_form(o.type, names)}" for o in sorted(objects))
    facts = "\n".join(f"   {_fact(a, names)}" for a in sorted(initial) if not is_denial(a))
    conjunctions = [f"(and {' '.join(_wanted(a, names) for a in sorted(goal))})" for goal in goals]
    wanted = conjunctions[0] if len(conjunctions) == 1 else f"(or {' '.join(conjunctions)})"
    table = "".join(f";@ name {kind} {form} {original}\n" for kind, form, original in names.changed())
    return (
        f"{table}(define (problem {names.form('problem', name)})\n"
        f" (:domain {names.form('domain', model.vocabulary.name)})\n"
        f" (:objects\n{things}\n )\n (:init\n{facts}\n )\n (:goal {wanted})\n)\n"
    )


def _names_of_domain(shown: WorldModel) -> PddlNames:
    """The names that the domain file uses, to which those of a problem are added."""
    names = PddlNames()
    _domain(shown, names)
    return names


def write_plan(model: WorldModel, objects: Iterable[Object], plan: Iterable[GroundOperator]) -> str:
    """A plan as planning competitions write it, one ``(action object ...)`` a line, with the names of the files above.

    ``objects`` are all of the task, as given to ``write_problem``.
    """
    shown = described(model)
    names = _names_of_domain(shown)
    for o in sorted(objects):
        names.form("object", o.name)
    forms = {op.name: names.form("action", new.name) for op, new in zip(model.operators, shown.operators, strict=True)}

    def line(step: GroundOperator) -> str:
        bound = dict(zip(step.operator.parameters, step.objects, strict=True))
        objects = (names.form("object", bound[v].name) for v in arguments_first(step.operator))
        return f"({' '.join((forms[step.operator.name], *objects))})\n"

    return "".join(map(line, plan))


def _type_form(t: Type, names: PddlNames) -> str:
    return "object" if t.name == "object" and t.parent is None else names.form("type", t.name)


def _type_line(t: Type, names: PddlNames) -> str:
    return f"   {_type_form(t, names)} - {_type_form(t.parent, names) if t.parent else 'object'}"


def _predicate_line(p: Predicate, names: PddlNames) -> str:
    arguments = " ".join(f"?a{i} - {_type_form(t, names)}" for i, t in enumerate(p.types))
    line = f"   ({' '.join(filter(None, (names.form('predicate', p.name), arguments)))})"
    return f"{line}  ; {p.description}" if p.description else line


def _wanted(atom: Atom, names: PddlNames) -> str:
    return f"(not {_fact(contrary(atom), names)})" if is_denial(atom) else _fact(atom, names)


def _fact(atom: Atom, names: PddlNames) -> str:
    objects = (names.form("object", o.name) for o in atom.objects)
    return f"({' '.join((names.form('predicate', atom.predicate.name), *objects))})"


def _action(op: Operator, names: PddlNames) -> str:
    def lifted(atoms: Iterable[LiftedAtom]) -> list[str]:
        return [
            f"({' '.join((names.form('predicate', a.predicate.name), *(v.name for v in a.variables)))})"
            for a in sorted(atoms)
        ]

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
