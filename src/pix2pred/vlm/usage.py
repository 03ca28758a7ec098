"""Counting what a model was asked."""

from __future__ import annotations

import threading
from collections import Counter
from dataclasses import dataclass, field

from pix2pred.vlm.request import VLM, Answer, Request


@dataclass(slots=True)
class Usage:
    """Queries and stored answers per purpose."""

    queries: Counter[str] = field(default_factory=Counter)
    stored: Counter[str] = field(default_factory=Counter)

    def as_dict(self) -> dict[str, dict[str, int]]:
        """JSON-compatible counts, sorted by purpose."""
        return {
            purpose: {"queries": self.queries[purpose], "from_store": self.stored[purpose]}
            for purpose in sorted(self.queries)
        }


class CountingVLM:
    """Passes requests on and counts them in ``usage``."""

    def __init__(self, model: VLM) -> None:
        self.name = model.name
        self.usage = Usage()
        self._model = model
        self._lock = threading.Lock()

    def answer(self, request: Request) -> Answer:
        """The model's answer, counted."""
        answer = self._model.answer(request)
        with self._lock:
            self.usage.queries[request.purpose] += 1
            self.usage.stored[request.purpose] += answer.stored
        return answer
