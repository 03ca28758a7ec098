"""What a run would ask: every request is made as it would be, and none is sent.

Proposals that are in the answer store are taken from there. In place of the others stands an assumed proposal, and
in place of every labelling answer one with a line for each atom, so that histories have a realistic length.
"""

from __future__ import annotations

import threading
from collections import Counter, defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from pix2pred.vlm.control.guard import Expected
from pix2pred.vlm.control.repeated import Repeated
from pix2pred.vlm.model_spec import Rates
from pix2pred.vlm.offline.prompt_format import (
    asked_atoms,
    defined_words,
    history_line,
    label_answer,
    object_types,
    states_shown,
    value_line,
)
from pix2pred.vlm.request import VLM, Answer, Purpose, Request, VLMError

CHARACTERS_PER_TOKEN = 4
ASSUMED_WORDS = 8
"""Predicates assumed per type and argument place where no proposal is stored."""
CHANGING = 4
"""One atom in so many is assumed to change once in a question about several states."""
PROPOSING = (Purpose.PROPOSE, Purpose.DEFINE)
_WHY = "It looks as it did before; nothing that happened to it changes this."


@dataclass(frozen=True, slots=True)
class Estimate:
    """Counts of one purpose. ``dollars`` are without ``cached_tokens``: no provider promises what its cache holds."""

    queries: int
    from_store: int
    pictures: int
    atoms: int
    input_tokens: int
    cached_tokens: int
    output_tokens: int
    dollars: float | None


class EstimatingVLM:
    """Answers without asking and counts what would have been sent.

    ``around`` makes the model out of what counts the questions to a store: that alone, or something that asks it less.
    ``thinking`` are the tokens a model thinks about each question; ``None`` for as many as it usually does.
    """

    def __init__(
        self, around: Callable[[Callable[[VLM], VLM]], VLM], rates: Rates | None, thinking: int | None = None
    ) -> None:
        self.assumed = False
        self._model = around(lambda stored: _Counted(self, stored))
        self.name = self._model.name
        self._rates = rates
        self._thinking = thinking if thinking is not None else rates.thinking_tokens() if rates else 0
        self._counts: defaultdict[str, Counter[str]] = defaultdict(Counter)
        self._sent: defaultdict[str, list[Request]] = defaultdict(list)
        self._lock = threading.Lock()

    def answer(self, request: Request) -> Answer:
        """The stored answer, or an assumed one."""
        return self._model.answer(request)

    def counted(self, stored: VLM, request: Request) -> Answer:
        """The answer of ``stored``, or an assumed one, counted."""
        try:
            answer = stored.answer(request)
        except VLMError:
            answer = Answer(self._assumed(request))
        with self._lock:
            count = self._counts[request.purpose]
            count["queries"] += 1
            count["from_store"] += answer.stored
            if not answer.stored:
                count["pictures"] += len(request.views)
                count["atoms"] += 0 if request.purpose in PROPOSING else sum(1 for _ in asked_atoms(request.text))
                count["input"] += len(request.text) // CHARACTERS_PER_TOKEN
                count["output"] += len(answer.text) // CHARACTERS_PER_TOKEN
                if self._rates is not None:
                    count["input"] += sum(self._rates.picture_tokens(*view.shown_size) for view in request.views)
                    self._sent[request.purpose].append(request)
                    count["output"] += self._thinking
        return answer

    def _cached(self, requests: list[Request], rates: Rates) -> int:
        """Input tokens that the provider would read from its cache, were each question asked after the one before."""
        repeated, tokens = Repeated(), 0
        for request in sorted(requests, key=lambda r: (r.about, r.text)):
            shared = repeated.beginning(request)
            seen = sum(rates.picture_tokens(*part.shown_size) for part in shared.parts if not isinstance(part, str))
            tokens += rates.cached_tokens(shared.characters // CHARACTERS_PER_TOKEN + seen)
        return tokens

    def estimates(self) -> dict[str, Estimate]:
        """Counts per purpose, sorted."""
        return {purpose: self._estimate(purpose, count) for purpose, count in sorted(self._counts.items())}

    def as_dict(self) -> dict[str, Any]:
        """JSON-compatible counts and their sum."""
        rows = self.estimates()
        prices = [e.dollars for e in rows.values()]
        fields = ("queries", "from_store", "pictures", "atoms", "input_tokens", "cached_tokens", "output_tokens")
        return {
            "model": self.name,
            "assumed_predicates": self.assumed,
            "stages": {p: {f: getattr(e, f) for f in (*fields, "dollars")} for p, e in rows.items()},
            **{f: sum(getattr(e, f) for e in rows.values()) for f in fields},
            "dollars": None if any(p is None for p in prices) else round(sum(p or 0.0 for p in prices), 4),
        }

    def expected(self) -> Expected:
        """What would be asked, in sum."""
        rows = [e for e in self.estimates().values() if e.queries > e.from_store]
        prices = [e.dollars for e in rows]
        dollars = None if None in prices else sum(p or 0.0 for p in prices)
        return Expected(sum(e.queries - e.from_store for e in rows), sum(e.output_tokens for e in rows), dollars)

    def _estimate(self, purpose: str, count: Counter[str]) -> Estimate:
        cached = self._cached(self._sent[purpose], self._rates) if self._rates else 0
        price = self._rates.dollars(count["input"], count["output"]) if self._rates else None
        return Estimate(
            count["queries"], count["from_store"], count["pictures"], count["atoms"],
            count["input"], cached, count["output"], price,
        )  # fmt: skip

    def _assumed(self, request: Request) -> str:
        match request.purpose:
            case Purpose.PROPOSE | Purpose.DEFINE:
                return self._assumed_proposal(request)
            case Purpose.HISTORY:
                states = list(states_shown(request.views))
                half = states[len(states) // 2]
                return "\n".join(
                    history_line(
                        atom, {n: n >= half for n in states} if i % CHANGING == 0 else dict.fromkeys(states, False)
                    )
                    for i, atom in enumerate(asked_atoms(request.text))
                )
            case _:
                return _labels(request)

    def _assumed_proposal(self, request: Request) -> str:
        """``ASSUMED_WORDS`` unary predicates of every type, and as many binary ones of neighbouring types."""
        self.assumed = True
        first: dict[str, str] = {}
        for name, kind in object_types(request.text).items():
            first.setdefault(kind, name)
        names = list(first.values())
        unary = [f"assumed_{i}({name})" for name in names for i in range(ASSUMED_WORDS)]
        pairs = list(pairwise(names))
        if request.purpose == Purpose.DEFINE:
            known = {word for word, _ in defined_words(request.text)}
            atoms = [a for a in unary if a.partition("(")[0] not in known]
            return "\n".join(f"* {atom} | CHANGES | {_WHY}" for atom in atoms)
        return "\n".join(unary + [f"assumed_{i}({a}, {b})" for a, b in pairs for i in range(ASSUMED_WORDS // 2)])


@dataclass(frozen=True, slots=True)
class _Counted:
    """A stored model whose questions are counted."""

    counts: EstimatingVLM
    stored: VLM

    @property
    def name(self) -> str:
        return self.stored.name

    def answer(self, request: Request) -> Answer:
        return self.counts.counted(self.stored, request)


def _labels(request: Request) -> str:
    lines = [value_line(atom, False, _WHY) for atom in asked_atoms(request.text)]
    return label_answer(request.text, lines)
