"""Predicates, the source of their values, and atoms (method 1.5)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from pix2pred.structs.objects import Object, Type, Variable


@dataclass(frozen=True, slots=True)
class FromDomain:
    """Values come from a classifier of a registered domain (a simulator or a robot's perception)."""


@dataclass(frozen=True, slots=True)
class FromHuman:
    """Values are listed by a person, state by state."""


@dataclass(frozen=True, slots=True)
class FromVLM:
    """Values come from asking a vision-language model about ``phrase(obj1, obj2)``.

    What the model itself declared when it proposed the word: ``also`` are words that mean the same, ``opposite`` those
    that mean the contrary, and ``changes`` says whether a skill can change it.
    """

    phrase: str
    also: tuple[str, ...] = ()
    opposite: tuple[str, ...] = ()
    changes: bool = True


@dataclass(frozen=True, slots=True)
class FromFeatures:
    """Values come from an expression over object features, e.g. ``(<= robot.fingers 0.5)``."""

    expression: str


@dataclass(frozen=True, slots=True)
class SkillTrigger:
    """A skill execution that changes an atom; ``args[i]`` is the skill argument bound to atom argument i."""

    skill: str
    args: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class FromSkills:
    """Declared knowledge: named skills set and clear the atom (for what no camera sees, e.g. holding)."""

    set_by: tuple[SkillTrigger, ...] = ()
    cleared_by: tuple[SkillTrigger, ...] = ()
    initially: bool = False


@dataclass(frozen=True, slots=True)
class FromOpposite:
    """An atom holds where the same atom of predicate ``of`` does not: so goals say what must not hold."""

    of: Predicate


Source = FromDomain | FromHuman | FromVLM | FromFeatures | FromSkills | FromOpposite
DeclaredSource = Literal["domain", "human", "vlm", "features", "skills"]
SourceName = Literal[DeclaredSource, "opposite"]


def source_name(source: Source) -> SourceName:
    """The word a file uses for ``source``."""
    match source:
        case FromDomain():
            return "domain"
        case FromHuman():
            return "human"
        case FromVLM():
            return "vlm"
        case FromFeatures():
            return "features"
        case FromSkills():
            return "skills"
        case FromOpposite():
            return "opposite"


@dataclass(frozen=True, slots=True)
class Predicate:
    """A named relation over typed arguments; ``source`` says where its values come from.

    Name and types make a predicate what it is. The source is no part of that: what a simulator reports and what a
    person lists are atoms of the same predicate. Whether a predicate is initial (given) or selected is a fact about a
    world model, not about the predicate. ``description`` says in a sentence when an atom of the predicate is true, for
    people and for models that are asked; empty when nobody has said so.
    """

    name: str
    types: tuple[Type, ...]
    source: Source = field(compare=False)
    description: str = field(default="", compare=False)

    def __hash__(self) -> int:
        return hash(self.name)

    @property
    def arity(self) -> int:
        """Number of arguments."""
        return len(self.types)

    @property
    def signature(self) -> str:
        """The printed form with argument types, ``On(item, object)``."""
        return f"{self.name}({', '.join(t.name for t in self.types)})"

    def __lt__(self, other: Predicate) -> bool:
        return (self.name, [t.name for t in self.types]) < (other.name, [t.name for t in other.types])

    def __call__(self, *objects: Object) -> Atom:
        """The atom of this predicate over ``objects``."""
        return Atom(self, objects)

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class Atom:
    """A predicate applied to objects; a closed-world fact."""

    predicate: Predicate
    objects: tuple[Object, ...]

    def __lt__(self, other: Atom) -> bool:
        return (self.predicate.name, self.objects) < (other.predicate.name, other.objects)

    def __str__(self) -> str:
        return f"{self.predicate.name}({', '.join(o.name for o in self.objects)})"


@dataclass(frozen=True, slots=True)
class LiftedAtom:
    """A predicate applied to variables."""

    predicate: Predicate
    variables: tuple[Variable, ...]

    def ground(self, binding: Mapping[Variable, Object]) -> Atom:
        """The atom under ``binding``, which must cover every variable."""
        return Atom(self.predicate, tuple(binding[v] for v in self.variables))

    def __lt__(self, other: LiftedAtom) -> bool:
        return (self.predicate.name, self.variables) < (other.predicate.name, other.variables)

    def __str__(self) -> str:
        return f"{self.predicate.name}({', '.join(v.name for v in self.variables)})"


_APPLICATION = re.compile(r"\s*([^\s()]+)\s*\(([^()]*)\)\s*\Z")
_NEGATED = re.compile(r"\s*\(?\s*(?:not\b|[!~\u00ac])", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Application:
    """A name applied to argument names, as written in a text: ``On(a, b)``."""

    name: str
    args: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.name}({', '.join(self.args)})"


def parse_application(text: str) -> Application:
    """Read ``Name(arg, arg)``. Raises ``ValueError`` when ``text`` has another form."""
    match = _APPLICATION.match(text)
    if _NEGATED.match(text):
        raise ValueError(
            f"{text!r} is negated, and only goals may say what must not hold: declare a predicate that "
            "says the opposite, such as Outside for 'not In', and write that"
        )
    if match is None:
        raise ValueError(f"expected Name(object, ...), found {text!r}")
    args = [part.strip() for part in match[2].split(",")]
    if args == [""]:
        args = []
    if not all(args):
        raise ValueError(f"an argument is empty in {text!r}")
    return Application(match[1], tuple(args))
