"""A question to a vision-language model, and its answer: the interface behind which every model hangs."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Protocol, runtime_checkable

from pix2pred.structs.views import View
from pix2pred.system.errors import Pix2predError

Part = str | View
"""Text, or a picture and how to show it."""


class Purpose(StrEnum):
    """The step of the method that asks: models that are simulated answer by it, and usage is counted by it."""

    PROPOSE = "propose"
    DEFINE = "define"
    """Predicates with their meanings: the frugal protocol's proposals."""
    LABEL = "label"
    HISTORY = "label-history"
    """Labels of several states in one answer: the frugal protocol's labels."""
    DOUBLE_CHECK = "double-check"
    ASK_AGAIN = "ask-again"
    PLAN = "plan"
    """Skills to execute, of baselines that plan with the model
    alone."""
    CODE = "code"
    """Classifiers in Python, of the baseline that has the model
    write predicates over features."""
    DOCTOR = "doctor"
    DETECT = "detect"
    """Boxes around described objects, for a robot that has no detector of its own."""


@dataclass(frozen=True, slots=True)
class Review:
    """What is wrong with an answer; ``usable`` when something can be read from it all the same."""

    problem: str
    usable: bool


Reviewer = Callable[[str], Review | None]
"""Reads an answer as the asker will; ``None`` when nothing is wrong with it."""


@dataclass(frozen=True, slots=True)
class Request:
    """Text and pictures in order. ``purpose`` names the step that asks; it is no part of the question.

    ``sample`` numbers independent samples of one question; ``attempt`` numbers retries after unusable answers.
    ``max_tokens`` is the answer budget. ``schema`` is a JSON Schema the answer should follow, as text, where the model
    can do that; ``logprobs`` asks for the probabilities of the answer's tokens. ``about`` names the demonstration and
    state for people, ``demo`` is the name of the demonstration alone, by which questions are counted, ``review`` lets a
    model behind a person give back what cannot be read, and ``upcoming`` are pictures of the question that will
    probably follow, to be made ready while the model thinks: none of the four is part of the question.
    """

    purpose: Purpose
    parts: tuple[Part, ...]
    max_tokens: int
    temperature: float = 0.0
    sample: int = 0
    attempt: int = 0
    schema: str = ""
    logprobs: bool = False
    about: str = field(default="", compare=False)
    demo: str = field(default="", compare=False)
    review: Reviewer | None = field(default=None, compare=False)
    upcoming: tuple[View, ...] = field(default=(), compare=False)

    @property
    def text(self) -> str:
        """All text parts, joined by blank lines."""
        return "\n\n".join(part for part in self.parts if isinstance(part, str))

    @property
    def views(self) -> tuple[View, ...]:
        """The pictures, in order."""
        return tuple(part for part in self.parts if isinstance(part, View))

    def canonical(self, model: str) -> dict[str, Any]:
        """What the answer may depend on, JSON-compatible: the same on every machine."""
        extra: dict[str, Any] = {"schema": self.schema} if self.schema else {}
        extra |= {"logprobs": True} if self.logprobs else {}
        return {
            "model": model,
            "temperature": self.temperature,
            "max_tokens": self.max_tokens,
            "sample": self.sample,
            "attempt": self.attempt,
            **extra,
            "parts": [part if isinstance(part, str) else part.canonical() for part in self.parts],
        }

    def key(self, model: str) -> str:
        """SHA-256 of the canonical form."""
        return key_of(self.canonical(model))


def key_of(canonical: Any) -> str:
    """The key of a request in its canonical form."""
    text = json.dumps(canonical, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


class Finish(StrEnum):
    """How an answer ended."""

    COMPLETE = "complete"
    CUT_SHORT = "cut short"
    """The token budget was used up."""
    TOO_LARGE = "too large"
    """It was never begun, because the model allows no such
    budget."""
    REFUSED = "refused"
    """The provider refused it."""
    NONE = "none"
    """It was never obtained."""


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of an answer; ``logprobs`` are natural logarithms of probabilities, of it and of what else was likely."""

    text: str
    logprobs: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True)
class Spent:
    """What an answer took: tokens as the provider counts them, US dollars (``None``: unknown) and seconds.

    ``cached_tokens`` are those of the input that the provider read from its prompt cache, at a lower price.
    """

    input_tokens: int = 0
    output_tokens: int = 0
    dollars: float | None = None
    seconds: float = field(default=0.0, compare=False)
    cached_tokens: int = 0


@dataclass(frozen=True, slots=True)
class Answer:
    """What a model said. ``stored`` tells that it came from the answer store rather than from the model.

    ``tokens`` are there when their probabilities were asked for and the model gives them; their texts join to ``text``.
    """

    text: str
    stored: bool = False
    finish: Finish = Finish.COMPLETE
    tokens: tuple[Token, ...] = ()
    spent: Spent = Spent()


class VLMError(Pix2predError, RuntimeError):
    """A model could not be asked; the message says why and what to do. It ends the run.

    ``spent`` is what an answer took that is of no use and was paid for all the same.
    """

    spent: Spent | None = None


class NoAnswerError(VLMError):
    """One question got no answer, whatever was tried; others may. The run goes on and names the gap."""


class VLM(Protocol):
    """Anything that answers requests. ``name`` identifies model and version and enters the store's keys."""

    @property
    def name(self) -> str:
        """Model and version."""
        ...

    def answer(self, request: Request) -> Answer:
        """Answer ``request``. Raises ``VLMError``. May be called from several threads."""
        ...


@runtime_checkable
class Stoppable(Protocol):
    """A model that may wait for long: ``stop`` ends its waiting when the run is over."""

    def stop(self) -> None:
        """End all waiting; questions that wait raise ``NoAnswerError``."""
        ...


@runtime_checkable
class Leaning(Protocol):
    """A model that can say what it is not sure of, with its probability, in place of asking another.

    Its probabilities were measured on what it had not seen.
    """

    def leaning(self) -> VLM:
        """The same model for those who weigh probabilities, and ask again about what they need to know."""
        ...
