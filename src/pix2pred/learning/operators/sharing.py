"""What operators share: with which types of objects a skill was shown, and whether one operator came of it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pix2pred.structs import LabelledDemo, Operator, Skill


@dataclass(frozen=True, slots=True)
class Sharing:
    """An argument of a skill, declared over ``declared`` and shown with objects of the types ``shown``, by name.

    ``learned`` are the types of the argument in the operators of the skill; ``shared``: all have the declared type, so
    that they are about any object of it, shown or not.
    """

    skill: str
    argument: int
    declared: str
    shown: tuple[str, ...]
    learned: tuple[str, ...]

    @property
    def shared(self) -> bool:
        """Whether nothing tells the types apart."""
        return self.learned == (self.declared,)


def sharing(operators: Sequence[Operator], demos: Iterable[LabelledDemo]) -> tuple[Sharing, ...]:
    """Every argument that was shown with objects of types below the declared one, in order of skills."""
    seen: dict[tuple[Skill, int], set[str]] = defaultdict(set)
    for demo in demos:
        for action in demo.actions:
            for i, item in enumerate(action.objects):
                seen[action.skill, i].add(item.type.name)
    found = []
    for (skill, i), names in sorted(seen.items(), key=lambda item: (item[0][0].name, item[0][1])):
        learned = tuple(sorted({op.skill_args[i].type.name for op in operators if op.skill.name == skill.name}))
        if learned and names != {skill.types[i].name}:
            found.append(Sharing(skill.name, i, skill.types[i].name, tuple(sorted(names)), learned))
    return tuple(found)
