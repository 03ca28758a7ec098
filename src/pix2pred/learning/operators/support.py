"""How operators and transitions fit: which transitions support an operator, and which speak against it.

An operator is read in a transition of its skill with its arguments bound to the skill's. It is supported when exactly
its effects occur; it is contradicted when its preconditions hold and something else happens.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice, product

from pix2pred.structs import AbstractState, Action, Atom, GroundOperator, LabelledDemo, Object, Operator

MOST_BINDINGS = 5000
"""Bindings of an operator's other parameters looked at in one transition."""


class Verdict(StrEnum):
    """What a transition says of an operator."""

    SUPPORTS = "supports"
    UNMET = "effects occur although a precondition does not hold"
    CONTRADICTS = "preconditions hold but other effects occur"


@dataclass(frozen=True, slots=True)
class Reading:
    """One operator in one transition, under the binding that fits best.

    ``unmet`` preconditions do not hold before; ``absent`` effects did not occur; ``surplus`` changes were not expected.
    Changes are written with a sign, ``+`` for what becomes true.
    """

    operator: str
    demo: str
    step: int
    binding: tuple[str, ...]
    verdict: Verdict
    unmet: tuple[str, ...]
    absent: tuple[str, ...]
    surplus: tuple[str, ...]


def readings(operators: Sequence[Operator], demos: Iterable[LabelledDemo]) -> list[Reading]:
    """Every reading that supports or contradicts one of ``operators``; ``demos`` hold the model's predicates alone."""
    found = []
    for demo in demos:
        states = demo.abstract_states()
        for step, action in enumerate(demo.actions):
            for operator in operators:
                reading = _read(operator, demo, step, action, states[step], states[step + 1])
                if reading is not None:
                    found.append(reading)
    return found


def _read(
    operator: Operator, demo: LabelledDemo, step: int, action: Action, before: AbstractState, after: AbstractState
) -> Reading | None:
    gained, lost = after - before, before - after
    best: tuple[tuple[int, int], GroundOperator] | None = None
    for ground in islice(_groundings(operator, action, demo.objects), MOST_BINDINGS):
        differing = len(ground.add ^ gained) + len(ground.delete ^ lost)
        unmet = len(ground.preconditions - before)
        if (differing == 0 or unmet == 0) and (best is None or (differing, unmet) < best[0]):
            best = ((differing, unmet), ground)
    if best is None:
        return None
    (differing, missing), ground = best
    verdict = Verdict.CONTRADICTS if differing else Verdict.UNMET if missing else Verdict.SUPPORTS
    return Reading(
        operator.name,
        demo.name,
        step,
        tuple(o.name for o in ground.objects),
        verdict,
        tuple(str(a) for a in sorted(ground.preconditions - before)),
        _signed(ground.add - gained, ground.delete - lost),
        _signed(gained - ground.add, lost - ground.delete),
    )


def _groundings(operator: Operator, action: Action, objects: Sequence[Object]) -> Iterator[GroundOperator]:
    if operator.skill != action.skill:
        return
    bound = dict(zip(operator.skill_args, action.objects, strict=True))
    if not all(o.type.is_a(v.type) for v, o in bound.items()) or len(set(bound.values())) < len(bound):
        return
    rest = [o for o in sorted(objects) if o not in bound.values()]
    domains = [[bound[v]] if v in bound else [o for o in rest if o.type.is_a(v.type)] for v in operator.parameters]
    for choice in product(*domains):
        if len(set(choice)) == len(choice):
            yield operator.ground(choice)


def _signed(plus: Iterable[Atom], minus: Iterable[Atom]) -> tuple[str, ...]:
    return (*(f"+{a}" for a in sorted(plus)), *(f"-{a}" for a in sorted(minus)))
