"""What labelling gives for one state, what it is told about the state before, and what labels states (method 3)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

from pix2pred.predicates.labelling.asking import Gap, Occurrence
from pix2pred.predicates.labelling.settings import LabelSettings
from pix2pred.structs import Action, Atom, Demo, Label, Object, State
from pix2pred.system.errors import Pix2predError
from pix2pred.vlm import VLM, Together


@dataclass(frozen=True, slots=True)
class StateLabels:
    """Values of the queried atoms in one state and the answer text they were read from.

    ``confidence`` is the probability of a value, where known. ``unusable`` is the last answer when none held a value;
    ``text`` then lists the values carried over. ``gaps`` names the atoms that no answer gave a value.
    """

    values: dict[Atom, Label]
    text: str
    counts: Counter[Occurrence] = field(default_factory=Counter)
    unusable: str = ""
    confidence: dict[Atom, float] = field(default_factory=dict)
    gaps: tuple[Gap, ...] = ()


class UnusableAnswersError(Pix2predError, RuntimeError):
    """A model whose answers hold no label at all: taking them for False would invent a world."""

    @classmethod
    def after(cls, model: str, labels: Sequence[StateLabels]) -> UnusableAnswersError:
        """The error for ``labels``, with their number and the first answer."""
        unread = [s for s in labels if not s.counts[Occurrence.READ]]
        gaps = [gap for s in unread for gap in s.gaps]
        if gaps and not any(s.counts[Occurrence.UNUSABLE] for s in unread):
            return cls(f"{model} gave no answer about {len(gaps)} states; the first: {gaps[0].about}: {gaps[0].reason}")
        answers = [" ".join(s.unusable.split()) for s in labels if s.counts[Occurrence.UNUSABLE]]
        example = f"; the first answer begins {answers[0][:120]!r}" if answers and answers[0] else "; they are empty"
        return cls(f"{model} gave unusable answers about {len(answers)} states, without a single label{example}")


@dataclass(frozen=True, slots=True)
class StepToLabel:
    """An action, the states before and after it (``t`` is the number of the latter), and the labels before it.

    ``double_check`` has the model look over its answer (method 3.5).
    """

    before: State
    after: State
    t: int
    action: Action
    previous: StateLabels
    double_check: bool = False


class StateLabeller(Protocol):
    """Labels states by asking a model: of demonstrations when learning, and of tasks afterwards."""

    @property
    def vlm(self) -> VLM:
        """The model that is asked."""
        ...

    @property
    def settings(self) -> LabelSettings:
        """How it asks."""
        ...

    @property
    def together(self) -> Together:
        """How much is asked at once."""
        ...

    def asking(self, vlm: VLM) -> StateLabeller:
        """The same with another model."""
        ...

    def demo(self, demo: Demo, atoms: Sequence[Atom]) -> tuple[StateLabels, ...]:
        """Labels of ``atoms`` in every state of a demonstration."""
        ...

    def first(self, state: State, objects: Sequence[Object], atoms: Sequence[Atom], about: str = "") -> StateLabels:
        """Labels of a state of which nothing is known yet; ``about`` names it for people."""
        ...

    def next(self, step: StepToLabel, objects: Sequence[Object], atoms: Sequence[Atom], about: str = "") -> StateLabels:
        """Labels of the state after a skill, given those of the state before."""
        ...
