"""A question to a vision-language model, and its answer: the interface behind which every model hangs."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Any, Protocol

from pix2pred.structs.views import View

Part = str | View
"""Text, or a picture and how to show it."""


@dataclass(frozen=True, slots=True)
class Request:
    """Text and pictures in order. ``purpose`` names the step for usage counts, e.g. ``propose`` or ``label``.

    ``sample`` numbers independent samples of one question; ``attempt`` numbers retries after unusable answers.
    ``max_tokens`` is the answer budget.
    """

    purpose: str
    parts: tuple[Part, ...]
    max_tokens: int
    temperature: float = 0.0
    sample: int = 0
    attempt: int = 0

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
        return {
            "model": model,
            "temperature": self.temperature,
            "max_tokens": self.max_tokens,
            "sample": self.sample,
            "attempt": self.attempt,
            "parts": [part if isinstance(part, str) else part.canonical() for part in self.parts],
        }

    def key(self, model: str) -> str:
        """SHA-256 of the canonical form."""
        text = json.dumps(self.canonical(model), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class Answer:
    """What a model said. ``stored`` tells that it came from the answer store rather than from the model."""

    text: str
    stored: bool = False


class VLMError(RuntimeError):
    """A model could not be asked; the message says why and what to do."""


class VLM(Protocol):
    """Anything that answers requests. ``name`` identifies model and version and enters the store's keys."""

    name: str

    def answer(self, request: Request) -> Answer:
        """Answer ``request``. Raises ``VLMError``. May be called from several threads."""
        ...
