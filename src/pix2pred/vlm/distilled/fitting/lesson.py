"""What a reader learns from: looks, and labels of atoms in them with how much each counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.system.errors import Pix2predError
from pix2pred.vlm.distilled.regions import Names
from pix2pred.vlm.offline.label_question import Look


class LessonError(Pix2predError, ValueError):
    """Labels from which no reader can be made; the message says why and what would help."""


@dataclass(frozen=True, slots=True)
class Example:
    """A label of ``word(names)`` in the look with number ``look``; ``weight`` in (0, 1] is how far it is trusted."""

    look: int
    word: str
    names: Names
    label: bool
    weight: float = 1.0


@dataclass(frozen=True, slots=True)
class Lesson:
    """Looks, the demonstration or episode each belongs to, and labels of atoms in them."""

    looks: Sequence[Look]
    groups: Sequence[str]
    examples: Sequence[Example]


class FitSettings(BaseModel):
    """How a reader is trained, and when it says that it knows."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    sure: float = Field(0.85, gt=0.5, lt=1, description="least probability of an answer; below it, it does not know")
    strange: float = Field(
        1.5, ge=1, le=10, description="most strangeness of what is answered; 1 is the most of demonstrations left out"
    )
    least: int = Field(
        3, ge=2, description="examples of either value that a word needs, in two demonstrations at least"
    )
    most_rows: int = Field(500, ge=50, description="examples that are kept of objects of the same kinds")
    megabytes: float = Field(3.5, gt=0, le=5, description="of all rows kept together")
    copies: int = Field(2, ge=0, le=8, description="changed copies of each example: moved, scaled, brighter or darker")
    folds: int = Field(10, ge=2, description="parts into which demonstrations are divided when they are left out")
    seed: int = Field(0, ge=0, description="of what is drawn by chance")
