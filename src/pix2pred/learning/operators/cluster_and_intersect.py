"""Operators by cluster and intersect: soft-intersection preconditions, pruning of rare classes (method 5.4-5.5)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.learning.operators.clustering import Lifted, Partition, TransitionClass
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.transitions import Data
from pix2pred.structs import LiftedAtom, Operator, Variable


@dataclass(frozen=True, slots=True)
class Schema:
    """An operator in numbers: its class, its number in ``Op<number>``, and its preconditions."""

    number: int
    cls: TransitionClass
    pre: tuple[Lifted, ...]


def schemas(data: Data, classes: Partition, predicates: Sequence[int], settings: LearningSettings) -> list[Schema]:
    """The operators of the classes that enough transitions support; numbers keep the gaps (method 5.5)."""
    per_skill = Counter(cls.skill for cls in classes for _ in cls.members)
    kept = []
    for number, cls in enumerate(classes):
        if len(cls.members) >= settings.h_data_frac * per_skill[cls.skill] - 1e-9:
            kept.append(Schema(number, cls, preconditions(data, cls, predicates, settings)))
    return kept


def preconditions(
    data: Data, cls: TransitionClass, predicates: Sequence[int], settings: LearningSettings
) -> tuple[Lifted, ...]:
    """Atoms over the class's variables that hold beforehand in enough of its members (method 5.4)."""
    needed = max(1, settings.required_count(len(cls.members)))
    return tuple(
        (p, variables)
        for p in sorted(predicates)
        for variables, count in cls.counts_before(data, p).items()
        if count >= needed
    )


def to_operator(data: Data, schema: Schema) -> Operator:
    """The operator with names: variables ``?x0, ?x1, ...`` in the order of the first member's object names."""
    cls = schema.cls
    variables = tuple(Variable(f"?x{i}", t) for i, t in enumerate(cls.types))

    def atoms(lifted: Sequence[Lifted]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(data.predicates[p], tuple(variables[v] for v in args)) for p, args in lifted)

    return Operator(
        f"Op{schema.number}",
        variables,
        atoms(schema.pre),
        atoms(cls.add),
        atoms(cls.delete),
        data.skills[cls.skill],
        tuple(variables[v] for v in cls.skill_args),
        len(cls.members),
    )
