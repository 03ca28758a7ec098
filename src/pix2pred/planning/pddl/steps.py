"""The steps of a plan, and plan files."""

from __future__ import annotations

import re
from dataclasses import dataclass

from pix2pred.planning.pddl.read import PddlDomain, PddlProblem
from pix2pred.planning.pddl.syntax import PddlError, Place

_STEP = re.compile(r"\s*(?:[\d.]+\s*:\s*)?\(([^()]*)\)\s*(?:\[[\d.]+\]\s*)?(?:;.*)?\Z")


@dataclass(frozen=True, slots=True)
class PddlStep:
    """An action with the names of its objects."""

    action: str
    objects: tuple[str, ...]

    def __str__(self) -> str:
        return f"({' '.join((self.action, *self.objects))})"


def read_plan(text: str, domain: PddlDomain, problem: PddlProblem) -> tuple[PddlStep, ...]:
    """The steps of a plan file: one ``(action object ...)`` a line, as planners write it, comments after ``;``.

    Names may be the written or the original ones; case does not matter. Raises ``PddlError``.
    """
    names = {
        kind: {form.lower(): name for (k, form), name in problem.names.items() if k == kind}
        for kind in ("action", "object")
    }
    names["action"] |= {a.name.lower(): a.name for a in domain.actions}
    names["object"] |= {o.name.lower(): o.name for o in problem.objects}
    steps = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith(";"):
            continue
        match = _STEP.match(line)
        words = match[1].split() if match else []
        if not words:
            raise PddlError(Place(number, 1), f"expected (action object ...), found {line.strip()[:60]}")
        action, *objects = (w.lower() for w in words)
        steps.append(PddlStep(names["action"].get(action, action), tuple(names["object"].get(o, o) for o in objects)))
    return tuple(steps)
