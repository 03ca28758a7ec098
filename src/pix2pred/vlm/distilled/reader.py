"""``reader:DIR``: a distilled reader behind the interface of all models. It answers questions about labels alone.

A label is a function of the pictures of the state, their boxes and the atom; action texts are not read, and the value
before serves only to be repeated for an object that no picture shows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from pix2pred.vlm.distilled.files import CardDoc
from pix2pred.vlm.distilled.model import AtomReading, DistilledModel, Why
from pix2pred.vlm.distilled.question import LABELLING
from pix2pred.vlm.offline.label_question import LabelQuestion
from pix2pred.vlm.offline.prompt_format import (
    AskedAtom,
    KnownWord,
    asked_atoms,
    definition_answer,
    history_line,
    label_answer,
    proposal_answer,
    value_line,
)
from pix2pred.vlm.request import Answer, Purpose, Request, Token, VLMError

_LEAST = 1e-6
"""Of a probability whose logarithm is told."""


@dataclass(frozen=True, slots=True)
class Line:
    """One atom's line of an answer; ``probability`` is that of the value it gives, where it gives one."""

    text: str
    value: str = ""
    probability: float = 0.0


class DistilledReader:
    """Implements ``VLM``. ``name`` holds the digest of card and weights, so stored answers know their reader."""

    def __init__(self, model: DistilledModel, card: CardDoc, digest: str) -> None:
        self.name = f"reader:{digest[:12]}"
        self.card = card
        self._model = model
        self._words = [
            KnownWord(word, kinds, word, negated=False)
            for word, kinds in model.words
            if not any(kind.startswith("@") for kind in kinds)
        ]

    def answer(self, request: Request) -> Answer:
        """Labels, or the words it was taught. Raises ``VLMError`` for questions of another kind."""
        text = request.text
        if request.purpose in LABELLING:
            question = LabelQuestion.of(request)
            return written(text, self.lines(request.purpose, question, self.readings(question)))
        match request.purpose:
            case Purpose.PROPOSE:
                return Answer(proposal_answer(text, self._words))
            case Purpose.DEFINE:
                return Answer(definition_answer(text, self._words))
            case Purpose.ASK_AGAIN:  # it would say the same again, which is no second opinion
                again = "The same picture reads the same."
                return written(text, [Line(value_line(atom, None, again)) for atom in asked_atoms(text)])
        raise VLMError(f"{self.name}: reads labels, and cannot answer a {request.purpose} question; name another model")

    def readings(self, question: LabelQuestion) -> dict[int, dict[AskedAtom, AtomReading]]:
        """What is read of every atom in every state that is shown."""
        pairs = [(atom.word, atom.names) for atom in question.atoms]
        return {
            number: dict(zip(question.atoms, self._model.read(look, pairs), strict=True))
            for number, look in question.looks.items()
        }

    def lines(
        self, purpose: Purpose, question: LabelQuestion, readings: Mapping[int, Mapping[AskedAtom, AtomReading]]
    ) -> list[Line]:
        """The lines of an answer about all atoms; what no picture shows keeps its value."""
        if purpose == Purpose.HISTORY:
            return [Line(history_line(atom, dict(_values(atom, question, readings)))) for atom in question.atoms]
        return [
            label_line(atom, reading, question.before.get(str(atom)))
            for of_state in readings.values()
            for atom, reading in of_state.items()
        ]


def _values(
    atom: AskedAtom, question: LabelQuestion, readings: Mapping[int, Mapping[AskedAtom, AtomReading]]
) -> Iterator[tuple[int, bool | None]]:
    said = question.before.get(str(atom))
    for number, of_state in readings.items():
        reading = of_state[atom]
        said = said if reading.why == Why.UNSEEN else reading.value
        yield number, said


def label_line(atom: AskedAtom, reading: AtomReading, before: bool | None) -> Line:
    """The line about one atom of one state. A value that is kept because nothing shows it is no evidence: 0.5 sure."""
    if reading.why == Why.UNSEEN:
        word = "" if before is None else "True" if before else "False"
        return Line(value_line(atom, before, "No picture shows it; value as before."), word, 0.5)
    if reading.value is None:
        return Line(value_line(atom, None, f"The reader does not know: {reading.why}."))
    sure = reading.probability if reading.value else 1 - reading.probability
    word = "True" if reading.value else "False"
    return Line(value_line(atom, reading.value, f"Read from the picture, {sure:.3f} sure."), word, sure)


def written(question: str, lines: Sequence[Line]) -> Answer:
    """An answer with these lines, in the form that the prompt asks for, and with how sure each value is."""
    return Answer(label_answer(question, [line.text for line in lines]), tokens=tuple(tokens(question, lines)))


def tokens(question: str, lines: Sequence[Line]) -> Iterator[Token]:
    """The pieces of ``written``: the word of each value stands alone, with the probabilities of what it could be."""
    whole = label_answer(question, [line.text for line in lines])
    start = 0
    for line in lines:
        begin = whole.index(line.text, start)
        if line.value:
            place = begin + line.text.index(f": {line.value}") + 2
            yield Token(whole[start:place], ())
            yield value_token(line.value, line.probability)
            start = place + len(line.value)
    yield Token(whole[start:], ())


def value_token(value: str, probability: float) -> Token:
    """The word of a value, with how probable it and its contrary are."""
    other = "False" if value == "True" else "True"
    odds = (math.log(max(probability, _LEAST)), math.log(max(1 - probability, _LEAST)))
    return Token(value, ((value, odds[0]), (other, odds[1])))
