"""How the nouns are written in files: one pydantic model per noun, shared by every format."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from pix2pred.structs.predicates import DeclaredSource

Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_\-]*$", max_length=100)]
"""Names of types, objects and skills: a letter, then letters, digits, ``_`` or ``-``."""

PredicateName = Annotated[str, StringConstraints(pattern=r"^[^\s(),;\"']+$", max_length=300)]
"""Predicate names also allow the brackets and signs of feature predicates."""

Word = Annotated[str, StringConstraints(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=100)]
"""A word that stands before the objects in a question to a model."""

Description = Annotated[
    str,
    StringConstraints(max_length=500, pattern=r"^[^\n\r]*$"),
    Field(description="one sentence: what it means, for people and for models that are asked"),
]
"""What a predicate or a skill means, on one line."""

Applied = Annotated[tuple[str, ...], Field(min_length=1)]
"""A predicate or skill and its variables, ``[name, variable, ...]``."""


class Document(BaseModel):
    """Base of everything read from a file: unknown keys are errors, values never change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class TypeDoc(Document):
    """A type: its name, its parent's name and the names of its numeric features."""

    name: Name
    parent: Name | None = None
    features: tuple[Name, ...] = ()
    description: Description = ""
    measures: Description = Field("", description="what the features mean, with their units, for models that compute")


class ObjectDoc(Document):
    """An object: its type and the phrase that picks it out in the pictures (default: its name)."""

    type: Name
    descriptor: str = ""


class SkillDoc(Document):
    """A skill: argument types, and lower and upper bounds of its continuous parameters."""

    name: Name
    types: tuple[Name, ...]
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    description: Description = ""


class TriggerDoc(Document):
    """A skill that changes an atom; ``args[i]`` is the position of the skill argument bound to argument i."""

    skill: Name
    args: tuple[int, ...]


class PredicateDoc(Document):
    """A predicate with its argument types and the source of its values."""

    name: PredicateName
    types: tuple[Name, ...]
    source: DeclaredSource = "domain"
    phrase: str | None = Field(None, description="source vlm: the word used in queries; default: the name")
    expression: str | None = Field(None, description="source features: e.g. (<= robot.fingers 0.5)")
    set_by: tuple[TriggerDoc, ...] = Field((), description="source skills: skills that make the atom true")
    cleared_by: tuple[TriggerDoc, ...] = Field((), description="source skills: skills that make it false")
    initially: bool = Field(False, description="source skills: the value before the first skill")
    also: tuple[Word, ...] = Field((), description="source vlm: words the model declared to mean the same")
    opposite: tuple[Word, ...] = Field((), description="source vlm: words the model declared to mean the contrary")
    changes: bool = Field(True, description="source vlm: whether a skill can change it, as the model declared")
    description: Description = ""


class OperatorDoc(Document):
    """An operator; atoms are lists of a predicate name and variable names."""

    name: str
    parameters: tuple[tuple[str, Name], ...]
    preconditions: tuple[Applied, ...]
    add: tuple[Applied, ...]
    delete: tuple[Applied, ...]
    skill: Applied
    support: int = Field(0, ge=0)


class VocabularyDoc(Document):
    """Types, skills and initial predicates."""

    name: str
    types: tuple[TypeDoc, ...]
    skills: tuple[SkillDoc, ...]
    predicates: tuple[PredicateDoc, ...]
