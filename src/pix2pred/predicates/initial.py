"""Values of predicates that no query is needed for, by their source (method 1.5)."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.structs import (
    Action,
    Atom,
    FromDomain,
    FromFeatures,
    FromHuman,
    FromOpposite,
    FromSkills,
    FromVLM,
    Label,
    SkillTrigger,
    State,
)
from pix2pred.structs.expressions import evaluate, parse_expression
from pix2pred.structs.goals.opposites import contrary


def is_asked(atom: Atom) -> bool:
    """Whether the atom's value comes from querying a model."""
    return isinstance(atom.predicate.source, FromVLM)


def local_values(atom: Atom, states: Sequence[State], actions: Sequence[Action]) -> list[Label]:
    """The atom's value in every state of a trajectory; ``actions[t]`` leads from state t to t + 1.

    Raises ``ExpressionError`` when a feature expression needs a feature that the states lack.
    """
    match atom.predicate.source:
        case FromDomain() | FromHuman():
            return [Label.of(atom in state.given) for state in states]
        case FromFeatures(expression):
            parsed = parse_expression(expression)
            return [Label.of(evaluate(parsed, state, atom.objects)) for state in states]
        case FromSkills() as source:
            return _by_skills(source, atom, states[0], actions)
        case FromOpposite():
            there = local_values(contrary(atom), states, actions)
            return [Label.of(value == Label.FALSE) for value in there]
        case FromVLM():
            raise AssertionError(f"{atom} is labelled by a model, not locally")


def _by_skills(source: FromSkills, atom: Atom, first: State, actions: Sequence[Action]) -> list[Label]:
    """Declared knowledge: set and cleared by skills; true at first if listed there or declared so."""
    values = [Label.of(source.initially or atom in first.given)]
    for action in actions:
        value = values[-1]
        if action.failed:
            values.append(value)
            continue
        if any(_matches(trigger, action, atom) for trigger in source.cleared_by):
            value = Label.FALSE
        if any(_matches(trigger, action, atom) for trigger in source.set_by):
            value = Label.TRUE
        values.append(value)
    return values


def _matches(trigger: SkillTrigger, action: Action, atom: Atom) -> bool:
    return action.skill.name == trigger.skill and tuple(action.objects[i] for i in trigger.args) == atom.objects
