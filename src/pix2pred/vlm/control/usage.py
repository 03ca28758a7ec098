"""Counting what a model was asked, and what it took."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pix2pred.vlm.request import VLM, Answer, NoAnswerError, Request


@dataclass(slots=True)
class Count:
    """Queries of one kind: how many, and what they took.

    Tokens, dollars and seconds are those of answers that were asked for now; stored ones cost nothing again.
    """

    queries: int = 0
    from_store: int = 0
    unanswered: int = 0
    input_tokens: int = 0
    cached_tokens: int = 0
    output_tokens: int = 0
    dollars: float = 0.0
    unpriced: int = 0
    seconds: float = 0.0

    def add(self, answer: Answer) -> None:
        """Count one answer."""
        self.queries += 1
        self.from_store += answer.stored
        if not answer.stored:
            spent = answer.spent
            self.input_tokens += spent.input_tokens
            self.cached_tokens += spent.cached_tokens
            self.output_tokens += spent.output_tokens
            self.dollars += spent.dollars or 0.0
            self.unpriced += spent.dollars is None
            self.seconds += spent.seconds

    def as_dict(self) -> dict[str, Any]:
        """JSON-compatible; ``dollars`` is ``None`` when no answer had a price."""
        asked = self.queries - self.from_store - self.unanswered
        return {
            "queries": self.queries,
            "from_store": self.from_store,
            "unanswered": self.unanswered,
            "input_tokens": self.input_tokens,
            "cached_tokens": self.cached_tokens,
            "output_tokens": self.output_tokens,
            "dollars": round(self.dollars, 6) if asked > self.unpriced else None,
            "seconds": round(self.seconds, 3),
        }


@dataclass(slots=True)
class Usage:
    """Counts per purpose and, for those that name one, per demonstration."""

    purposes: dict[str, Count] = field(default_factory=dict)
    demos: dict[str, Count] = field(default_factory=dict)

    def as_dict(self) -> dict[str, dict[str, Any]]:
        """JSON-compatible counts, sorted by purpose."""
        return {purpose: count.as_dict() for purpose, count in sorted(self.purposes.items())}

    def demos_dict(self) -> dict[str, dict[str, Any]]:
        """JSON-compatible counts, sorted by demonstration."""
        return {demo: count.as_dict() for demo, count in sorted(self.demos.items())}

    @property
    def queries(self) -> int:
        """Questions so far, stored ones included."""
        return sum(c.queries for c in list(self.purposes.values()))

    def line(self) -> str:
        """The sum for people: ``41 queries (3 stored), 120k tokens, $0.42``."""
        counts = self.purposes.values()
        queries, stored = sum(c.queries for c in counts), sum(c.from_store for c in counts)
        tokens = sum(c.input_tokens + c.output_tokens for c in counts)
        parts = [f"{queries} queries" + (f" ({stored} stored)" if stored else "")]
        if tokens:
            parts.append(f"{tokens / 1000:.0f}k tokens" if tokens >= 1000 else f"{tokens} tokens")
        if dollars := sum(c.dollars for c in counts):
            parts.append(f"${dollars:.2f}" if dollars >= 0.1 else f"${dollars:.4f}")
        return ", ".join(parts)


class CountingVLM:
    """Passes requests on and counts them in ``usage``; ``on_answer`` is called after each."""

    def __init__(self, model: VLM) -> None:
        self.name = model.name
        self.usage = Usage()
        self.on_answer: Callable[[], None] = lambda: None
        self._model = model
        self._lock = threading.Lock()

    def answer(self, request: Request) -> Answer:
        """The model's answer, counted."""
        try:
            answer = self._model.answer(request)
        except NoAnswerError:
            with self._lock:
                for count in self._counts(request):
                    count.queries += 1
                    count.unanswered += 1
            raise
        with self._lock:
            for count in self._counts(request):
                count.add(answer)
            self.on_answer()
        return answer

    def _counts(self, request: Request) -> list[Count]:
        counts = [self.usage.purposes.setdefault(request.purpose, Count())]
        if request.demo:
            counts.append(self.usage.demos.setdefault(request.demo, Count()))
        return counts
