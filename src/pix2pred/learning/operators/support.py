"""How operators and transitions fit: which transitions support an operator, and which speak against it.

The arguments of an operator are bound to those its skill was executed with. A transition supports it when it ends in
the state that its effects make of the one before (what was so already need not change), and contradicts it when its
preconditions hold and something else happens.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice

from pix2pred.structs import AbstractState, Action, GroundOperator, LabelledDemo, Operator
from pix2pred.structs.plans import changes, signed

MOST_BINDINGS = 5000
"""Bindings of an operator's other parameters looked at in one transition: an operator of many unbound parameters may
find its best binding beyond them and then counts as silent."""


class SupportKind(StrEnum):
    """What a transition says about an operator of its skill."""

    SUPPORTS = "supports"
    UNMET = "effects occur although a precondition does not hold"
    CONTRADICTS = "preconditions hold but other effects occur"


@dataclass(frozen=True, slots=True)
class Support:
    """What one transition says about one operator, its parameters bound to the objects that fit best.

    ``binding`` holds the names of these objects; ``unmet`` the preconditions that do not hold before; ``absent`` the
    effects that did not occur; ``surplus`` the changes that the operator does not have. Changes are written with a
    sign, ``+`` for what becomes true.
    """

    operator: str
    demo: str
    step: int
    binding: tuple[str, ...]
    verdict: SupportKind
    unmet: tuple[str, ...]
    absent: tuple[str, ...]
    surplus: tuple[str, ...]


def operator_support(operators: Sequence[Operator], demos: Iterable[LabelledDemo]) -> list[Support]:
    """For every transition what it says for or against each of ``operators``, where it says anything.

    ``demos`` hold the labels of the model's predicates alone.
    """
    found = []
    for demo in demos:
        states = demo.abstract_states()
        for step, action in enumerate(demo.actions):
            for operator in operators:
                found_here = _support(operator, demo, step, action, states[step], states[step + 1])
                if found_here is not None:
                    found.append(found_here)
    return found


def _support(
    operator: Operator, demo: LabelledDemo, step: int, action: Action, before: AbstractState, after: AbstractState
) -> Support | None:
    if operator.skill != action.skill or action.failed:
        return None
    gained, lost = after - before, before - after
    fixed = dict(zip(operator.skill_args, action.objects, strict=True))
    best: tuple[tuple[int, int], GroundOperator] | None = None
    for ground in islice(operator.groundings(fixed, demo.objects), MOST_BINDINGS):
        differing = len((ground.add - before) ^ gained) + len((ground.delete & before) ^ lost)
        unmet = len(ground.preconditions - before)
        if (differing == 0 or unmet == 0) and (best is None or (differing, unmet) < best[0]):
            best = ((differing, unmet), ground)
    if best is None:
        return None
    (differing, missing), ground = best
    verdict = SupportKind.CONTRADICTS if differing else SupportKind.UNMET if missing else SupportKind.SUPPORTS
    return Support(
        operator.name,
        demo.name,
        step,
        tuple(o.name for o in ground.objects),
        verdict,
        tuple(str(a) for a in sorted(ground.preconditions - before)),
        signed(changes(ground.add - after, ground.delete & after)),
        signed(changes(gained - ground.add, lost - ground.delete)),
    )
