"""The noisy oracle: ground truth with seeded errors, for tests and noise studies only.

Nothing that users run offers it, and whatever it labels is stamped ``oracle``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, auto

from pix2pred.structs.views import View
from pix2pred.system.seeded import draw
from pix2pred.vlm.offline.prompt_format import (
    AskedAtom,
    KnownWord,
    asked_atoms,
    current_views,
    definition_answer,
    history_line,
    label_answer,
    proposal_answer,
    states_shown,
    value_line,
)
from pix2pred.vlm.request import Answer, Purpose, Request

TruthInView = Callable[[View, str, Sequence[str]], bool | None]
"""The true value of ``word(names)`` in the state a picture shows; None for words without a truth."""


@dataclass(frozen=True, slots=True)
class NoiseRates:
    """How often answers are wrong: probabilities per atom and state.

    A value is turned round, said to be unknown, left out, or written in a way that nobody reads.
    """

    flip: float = 0.0
    unknown: float = 0.0
    missing: float = 0.0
    malformed: float = 0.0


class _Error(Enum):
    FLIP = auto()
    UNKNOWN = auto()
    MISSING = auto()
    MALFORMED = auto()


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
        if request.purpose == Purpose.DEFINE:
            return Answer(definition_answer(request.text, self._words))
        if request.purpose == Purpose.HISTORY:
            return Answer("\n".join(filter(None, self._histories(request))))
        view = current_views(request.views)[0]
        lines = [self._label(view, atom) for atom in asked_atoms(request.text)]
        return Answer(label_answer(request.text, [line for line in lines if line]))

    def _histories(self, request: Request) -> Iterator[str]:
        """A line per atom; missing and malformed ones are decided by the first picture."""
        states = {number: shown[0] for number, shown in states_shown(request.views).items()}
        for atom in asked_atoms(request.text):
            kinds = {number: self._error(view, atom) for number, view in states.items()}
            first = kinds[next(iter(states))]
            if first in (_Error.MISSING, _Error.MALFORMED):
                yield "" if first is _Error.MISSING else f"* {atom} is perhaps true"
                continue
            values = {}
            for number, view in states.items():
                value = self._truth(view, atom.word, atom.names)
                values[number] = self._wrong_value(kinds[number], value)
            yield history_line(atom, values)

    def _label(self, view: View, atom: AskedAtom) -> str:
        value, kind = self._truth(view, atom.word, atom.names), self._error(view, atom)
        match kind:
            case _Error.MISSING:
                return ""
            case _Error.MALFORMED:
                return f"* {atom} is perhaps true"
            case _Error.UNKNOWN:
                return value_line(atom, None, "Cannot be seen.")
            case _:
                return value_line(atom, self._wrong_value(kind, value), "Ground truth.")

    def _wrong_value(self, kind: _Error | None, value: bool | None) -> bool | None:
        if kind is _Error.FLIP:
            return None if value is None else not value
        return None if kind is _Error.UNKNOWN else value

    def _error(self, view: View, atom: AskedAtom) -> _Error | None:
        """The error that this label has, if any."""
        left, rates = draw(self._seed, view.picture.image.digest, atom), self._rates
        for kind, rate in (
            (_Error.FLIP, rates.flip), (_Error.UNKNOWN, rates.unknown),
            (_Error.MISSING, rates.missing), (_Error.MALFORMED, rates.malformed),
        ):  # fmt: skip
            if left < rate:
                return kind
            left -= rate
        return None
