"""Predicates that never change and tell objects apart no better than chance would.

What a class of transitions has in common besides its effects may be an accident: three crates that were all dropped at
a large place are no reason to think that small places do not do. A predicate that changes is refuted by time, one that
never changes says one thing of every object, however many states repeat it.
"""

from __future__ import annotations

from itertools import product
from math import log

from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.operators.transition_class import OperatorSchema, Partition
from pix2pred.structs.objects import count_groundings


def told_by_chance(model: OperatorModel, classes: Partition, candidate: int, statics: int) -> bool:
    """Whether objects drawn blindly would meet the preconditions that ``candidate``, which never changes, gives.

    Two descriptions of the objects that skills were used with are compared, in nats. Without the predicate they were
    drawn from all of a demonstration's objects; a precondition saves minus the logarithm of the share of these that
    meet it, once for every demonstration and choice of objects, and costs the logarithm of the number of places where
    it could stand. The candidate itself, one of ``statics`` that never change, costs the logarithm of their number.
    """
    schemas = model.schemas(classes, (candidate,))
    wanted = model.data.predicates[candidate].types
    places = sum(
        len(list(product(*([t for t in schema.cls.types if t.is_a(w)] for w in wanted)))) for schema in schemas
    )
    shares = _shares(model, candidate)
    saved = [
        gain - log(places)
        for schema in schemas
        for _, variables in schema.pre
        if (gain := _gain(model, schema, variables, shares)) > log(places)
    ]
    return sum(saved) <= log(statics)


def _gain(model: OperatorModel, schema: OperatorSchema, variables: tuple[int, ...], shares: list[float]) -> float:
    """Nats that knowing the precondition over ``variables`` saves in telling what they were bound to."""
    transitions = model.data.transitions
    bound = {(transitions[m.transition].demo, *(m.objects[v] for v in variables)) for m in schema.cls.members}
    return -sum(log(shares[d]) for d, *_ in bound)


def _shares(model: OperatorModel, candidate: int) -> list[float]:
    """Of which share of the objects it may be about a predicate is true, by demonstration; 1 where that is none, since
    a demonstration without such objects tells nothing."""
    data = model.data
    found = []
    for d, demo in enumerate(data.demos):
        types = data.predicates[candidate].types
        every = count_groundings(types, [data.objects[o] for o in demo.objects], distinct=True)
        true = len(data.extension(d, 0, candidate))
        found.append(true / every if true else 1.0)
    return found
