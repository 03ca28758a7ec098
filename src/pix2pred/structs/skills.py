"""Skills and actions (method 1.3)."""

from __future__ import annotations

from dataclasses import dataclass, field

from pix2pred.structs.objects import Object, Type

FAILED = "failed"
"""What stands behind an action, as text, that failed."""


@dataclass(frozen=True, slots=True)
class Skill:
    """A named, parameterised behaviour: discrete argument types and a box for continuous parameters.

    ``description`` says in a sentence what the skill does and needs, for people and for models that are asked.
    """

    name: str
    types: tuple[Type, ...]
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    description: str = field(default="", compare=False)

    @property
    def dimension(self) -> int:
        """Number of continuous parameters."""
        return len(self.low)

    def __lt__(self, other: Skill) -> bool:
        return self.name < other.name

    def __str__(self) -> str:
        return f"{self.name}({', '.join(t.name for t in self.types)})"


@dataclass(frozen=True, slots=True)
class Action:
    """A skill with objects bound and continuous parameters chosen.

    ``failed`` says of an action in a demonstration that it did not do what the skill is for.
    """

    skill: Skill
    objects: tuple[Object, ...]
    params: tuple[float, ...] = ()
    failed: bool = False

    def __str__(self) -> str:
        text = f"{self.skill.name}({', '.join(o.name for o in self.objects)})"
        text += f"[{', '.join(repr(float(p)) for p in self.params)}]" if self.params else ""
        return text + (f" {FAILED}" if self.failed else "")
