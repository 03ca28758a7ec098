"""Reading the plan that a model wrote (method 9, ViLa): which lines count, which are dropped, where reading stops."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.structs import Action, Object, Skill, Type
from pix2pred.system.errors import Pix2predError

_PLAN = re.compile(r"^[\s*#>]*plan\s*:[\s*]*$", re.IGNORECASE)
_DECORATION = re.compile(r"^\s*(?:[-*]\s+|\d+[.)]\s*)?`?")
_STEP = re.compile(r"^\(([^()]*)\)\s*\[([^\[\]]*)\]")


class NoPlanError(Pix2predError, ValueError):
    """An answer without a plan."""


@dataclass(frozen=True, slots=True)
class WrittenPlan:
    """The skills read from an answer, the lines that were dropped, with reasons, and why reading stopped, if it did."""

    actions: tuple[Action, ...]
    dropped: tuple[str, ...]
    stopped: str = ""


class _DropError(ValueError):
    """This line is not used."""


class _StopError(ValueError):
    """This line and all after it are not used."""


def parse_plan(answer: str, skills: Sequence[Skill], types: Sequence[Type], objects: Sequence[Object]) -> WrittenPlan:
    """The plan after the first line ``Plan:``. Raises ``NoPlanError`` when there is no such line.

    An unknown skill, a missing bracket or a wrong count of numbers ends the plan, the steps before it are kept;
    a line whose objects or numbers are wrong in themselves is dropped.
    """
    lines = answer.splitlines()
    start = next((i for i, line in enumerate(lines) if _PLAN.match(line)), None)
    if start is None:
        raise NoPlanError("the answer has no line 'Plan:'")
    reader = _Reader({s.name: s for s in skills}, {t.name for t in types}, {o.prompt_name: o for o in objects})
    actions, dropped = [], []
    for line in lines[start + 1 :]:
        if not line.strip():
            continue
        try:
            actions.append(reader.step(_DECORATION.sub("", line, count=1).strip()))
        except _DropError as reason:
            dropped.append(f"{line.strip()[:100]}: {reason}")
        except _StopError as reason:
            return WrittenPlan(tuple(actions), tuple(dropped), f"{line.strip()[:100]}: {reason}")
    return WrittenPlan(tuple(actions), tuple(dropped))


@dataclass(frozen=True, slots=True)
class _Reader:
    skills: dict[str, Skill]
    types: set[str]
    objects: dict[str, Object]

    def step(self, text: str) -> Action:
        """One line. Raises ``_DropError`` or ``_StopError``."""
        if "(" not in text or "[" not in text:
            raise _StopError("a bracket is missing")
        name, _, rest = text.partition("(")
        skill = self.skills.get(name.strip())
        if skill is None:
            raise _StopError(f"no skill is called {name.strip()!r}")
        match = _STEP.match(f"({rest}")
        if match is None:
            raise _DropError("the lists of objects and numbers cannot be read")
        objects = self._objects(skill, match[1])
        return Action(skill, objects, self._numbers(skill, match[2]))

    def _objects(self, skill: Skill, text: str) -> tuple[Object, ...]:
        parts = [part.strip() for part in text.split(",")] if text.strip() else []
        objects = []
        for part in parts:
            name, colon, kind = (piece.strip() for piece in part.partition(":"))
            if not colon:
                raise _DropError(f"{part!r} is not object:type")
            if name not in self.objects:
                raise _DropError(f"no object is called {name!r}")
            if kind not in self.types:
                raise _DropError(f"no type is called {kind!r}")
            objects.append(self.objects[name])
        if len(objects) != len(skill.types):
            raise _DropError(f"{skill.name} takes {len(skill.types)} objects, found {len(objects)}")
        for thing, wanted in zip(objects, skill.types, strict=True):
            if not thing.type.is_a(wanted):
                raise _DropError(f"{thing.prompt_name} is no {wanted.name}")
        return tuple(objects)

    def _numbers(self, skill: Skill, text: str) -> tuple[float, ...]:
        parts = [part.strip() for part in text.split(",")] if text.strip() else []
        try:
            numbers = tuple(float(part) for part in parts)
        except ValueError as error:
            raise _DropError(f"{text.strip()!r} are not numbers") from error
        if not all(map(math.isfinite, numbers)):
            raise _DropError(f"{text.strip()!r} are not numbers")
        if len(numbers) != skill.dimension:
            raise _StopError(f"{skill.name} takes {skill.dimension} numbers, found {len(numbers)}")
        return numbers
