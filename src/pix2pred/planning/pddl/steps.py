"""The steps of a plan, and plan files."""

from __future__ import annotations

import re
from collections.abc import Sequence
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
    action = _Names("action", [a.name for a in domain.actions], problem)
    thing = _Names("object", [o.name for o in problem.objects], problem)
    steps = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith(";"):
            continue
        match = _STEP.match(line)
        words = match[1].split() if match else []
        if not words:
            raise PddlError(Place(number, 1), f"expected one (action object ...) a line, found {line.strip()[:60]}")
        steps.append(PddlStep(action.original(words[0]), tuple(map(thing.original, words[1:]))))
    return tuple(steps)


class _Names:
    """Original names by what stands in a plan: the written form, the name itself, or either in other letters' cases."""

    def __init__(self, kind: str, originals: Sequence[str], problem: PddlProblem) -> None:
        self._written = {form: name for (k, form), name in problem.names.items() if k == kind}
        self._originals = set(originals)
        self._lower = {name.lower(): name for name in sorted(originals)} | self._written

    def original(self, word: str) -> str:
        """The name that ``word`` stands for; ``word`` itself when nothing is called so."""
        if word in self._written or word not in self._originals:
            return self._lower.get(word.lower(), word)
        return word
