"""What a skill needs, whatever else it does: a precondition that all its operators have."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.operators.transition_class import OperatorSchema, TransitionClass
from pix2pred.learning.selection.stopping_rule import ScoredSet


def is_condition(model: OperatorModel, found: ScoredSet, skill: int) -> bool:
    """Whether all operators of a skill need the last predicate of ``found`` of the same arguments, and none changes it
    there.

    That what makes an atom true finds it false goes without saying, and that a patty is raw when it is picked from the
    counter is no condition of picking, since one that is picked from the grill is not.
    """
    p = found.predicate
    predicates = (*range(model.data.initial), *found.chosen)
    operators = [op for op in model.schemas(found.classes, predicates) if op.cls.skill == skill]
    places = {places for op in operators for q, v in op.pre if q == p for places in _places(op.cls, v)}
    return any(all(_needs(op, p, at) for op in operators if _fits(model, op, p, at)) for at in sorted(places))


def _places(cls: TransitionClass, variables: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """The arguments of the skill that the variables stand for, if they all do."""
    if all(v in cls.skill_args for v in variables):
        yield tuple(cls.skill_args.index(v) for v in variables)


def _fits(model: OperatorModel, op: OperatorSchema, p: int, places: Sequence[int]) -> bool:
    return model.data.fits(op.cls.types, p, [op.cls.skill_args[i] for i in places])


def _needs(op: OperatorSchema, p: int, places: Sequence[int]) -> bool:
    atom = p, tuple(op.cls.skill_args[i] for i in places)
    return atom in op.pre and atom not in op.cls.delete
