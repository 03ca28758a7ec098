"""The noisy oracle: ground truth with seeded errors, for tests and noise studies only.

Nothing that users run offers it, and whatever it labels is stamped ``oracle``.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pix2pred.structs.views import View
from pix2pred.vlm.offline.prompt_format import (
    AskedAtom,
    KnownWord,
    asked_atoms,
    current_views,
    label_answer,
    proposal_answer,
    value_line,
)
from pix2pred.vlm.request import Answer, Purpose, Request

TruthInView = Callable[[View, str, Sequence[str]], bool | None]
"""The true value of ``word(names)`` in the state a picture shows; None for words without a truth."""


@dataclass(frozen=True, slots=True)
class NoiseRates:
    """Probabilities, per atom and state, of a flipped, unknown, missing or malformed value."""

    flip: float = 0.0
    unknown: float = 0.0
    missing: float = 0.0
    malformed: float = 0.0


class NoisyOracle:
    """Implements ``VLM``. Errors depend on the seed, the picture and the atom alone: asking again changes nothing."""

    def __init__(
        self, words: Sequence[KnownWord], truth: TruthInView, rates: NoiseRates = NoiseRates(), seed: int = 0
    ) -> None:
        self.name = f"oracle:{seed}:{rates.flip}:{rates.unknown}:{rates.missing}:{rates.malformed}"
        self._words = words
        self._truth = truth
        self._rates = rates
        self._seed = seed

    def answer(self, request: Request) -> Answer:
        """Propose all words, or label with the errors asked for."""
        if request.purpose == Purpose.PROPOSE:
            return Answer(proposal_answer(request.text, self._words))
        view = current_views(request.views)[0]
        lines = [self._label(view, atom) for atom in asked_atoms(request.text)]
        return Answer(label_answer(request.text, [line for line in lines if line]))

    def _label(self, view: View, atom: AskedAtom) -> str:
        value = self._truth(view, atom.word, atom.names)
        draw = self._draw(view, atom)
        for kind in ("flip", "unknown", "missing", "malformed"):
            rate = getattr(self._rates, kind)
            if draw < rate:
                return self._wrong(kind, atom, value)
            draw -= rate
        return value_line(atom, value, "Ground truth.")

    def _wrong(self, kind: str, atom: AskedAtom, value: bool | None) -> str:
        if kind == "flip":
            return value_line(atom, None if value is None else not value, "Ground truth.")
        if kind == "unknown":
            return value_line(atom, None, "Cannot be seen.")
        return "" if kind == "missing" else f"* {atom} is perhaps true"

    def _draw(self, view: View, atom: AskedAtom) -> float:
        """A number in [0, 1) that only seed, picture and atom decide."""
        text = f"{self._seed}|{view.picture.image.digest}|{atom}"
        return int.from_bytes(hashlib.sha256(text.encode()).digest()[:7]) / 2**56
