"""What a person should know of a selection: signs that the model is too poor to plan with."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, auto

from pix2pred.learning.selection.result import ClimbEnd, Selection
from pix2pred.structs import Skill


class CautionKind(Enum):
    """What is wrong with a selection."""

    ENDED_AT_ONCE = auto()
    SKILL_WITHOUT_EFFECT = auto()
    OPERATOR_WITHOUT_PRECONDITION = auto()


@dataclass(frozen=True, slots=True)
class Caution:
    """One finding. ``about`` names the skill or operator it is about, if any; ``sentence`` is for people."""

    kind: CautionKind
    about: str
    sentence: str


def selection_cautions(selection: Selection, skills: Iterable[Skill]) -> tuple[Caution, ...]:
    """What a person should know before planning with a selection; ``skills`` are those of the demonstrations."""
    found: list[Caution] = []
    if selection.end is ClimbEnd.GOOD_ENOUGH_AT_ONCE:
        found.append(Caution(
            CautionKind.ENDED_AT_ONCE, "",
            f"no candidate was tried: J = {selection.steps[0].j:,.0f} was good enough for early_stop and j_threshold; "
            "lower j_threshold, or use operators: robust, which has no threshold",
        ))  # fmt: skip
    for skill in sorted(skills):
        operators = [op for op in selection.operators if op.skill == skill]
        if not any(op.add or op.delete for op in operators):
            found.append(Caution(
                CautionKind.SKILL_WITHOUT_EFFECT, skill.name,
                f"{skill.name} has no effect in the learned model, so no plan has a reason to use it: a predicate that "
                "says what it changes is missing, or its labels are wrong",
            ))  # fmt: skip
    found += [
        Caution(
            CautionKind.OPERATOR_WITHOUT_PRECONDITION, op.name,
            f"{op.name} ({op.skill.name}) has no precondition, so plans use it anywhere: a predicate that says when it "
            "can be executed is missing, or its labels are wrong",
        )
        for op in selection.operators
        if (op.add or op.delete) and not op.preconditions
    ]  # fmt: skip
    return tuple(found)
