"""``cascade:READER,MODEL``: the reader says what it knows, and the large model is asked about the rest alone.

One question a look at most. In a seeded share of the looks, what the reader is sure of is put into the same question as
a check: whole looks, because a look costs one question whatever it asks about. The reader's answer stands all the same,
so that checking changes no result.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from pix2pred.system.seeded import draw
from pix2pred.vlm.distilled.model import AtomReading, Why
from pix2pred.vlm.distilled.question import LABELLING, about
from pix2pred.vlm.distilled.reader import DistilledReader, Line, written
from pix2pred.vlm.distilled.tally import Checked, Tally
from pix2pred.vlm.offline.label_question import LabelQuestion
from pix2pred.vlm.offline.prompt_format import AskedAtom
from pix2pred.vlm.request import VLM, Answer, Finish, NoAnswerError, Purpose, Request, Stoppable, Token

CHECKED = 0.02
"""The share of looks whose sure answers are checked, and so of sure answers."""

_LEANT = frozenset({Why.READ, Why.UNSURE, Why.UNSEEN})
"""What a reader can lean to something about; of what is strange to it or was not taught it knows nothing."""

SaidOf = Callable[[str, Sequence[str]], Mapping[str, bool]]
"""The values, true or false, that an answer gives to atoms, by their texts."""


@dataclass(slots=True)
class Cascade:
    """Implements ``VLM``. ``said_of`` reads the large model's answers, to compare them with the reader's.

    When it ``leans``, the asker weighs probabilities and asks again about what it needs: what the reader is not sure of
    is told with its probability, and what no picture shows keeps its value. The large model is asked about the rest.
    """

    reader: DistilledReader
    model: VLM
    said_of: SaidOf
    checked: float = CHECKED
    seed: int = 0
    leans: bool = False
    tally: Tally = field(default_factory=Tally)

    @property
    def name(self) -> str:
        """Both names."""
        return f"cascade:{self.reader.name.partition(':')[2]},{self.model.name}"

    def answer(self, request: Request) -> Answer:
        """The reader's lines and the large model's; what is no question about labels goes to the large model."""
        if request.purpose not in LABELLING:
            return self.model.answer(request)
        question = LabelQuestion.of(request)
        readings = self.reader.readings(question)
        sure = [a for a in question.atoms if readings and all(r[a].value is not None for r in readings.values())]
        look = _name_of(question)
        audited = (
            [a for a in sure if not self.tally.checked(look, str(a))] if draw(self.seed, look) < self.checked else []
        )
        leant = self._leant(request, question, readings) if not (request.schema and audited) else []
        told = [a for a in question.atoms if a in {*sure, *leant}]
        rest = [a for a in question.atoms if a not in {*told}]
        known = {number: {a: leaning(of_state[a]) for a in told} for number, of_state in readings.items()}
        lines = self.reader.lines(request.purpose, replace(question, atoms=tuple(told)), known)
        asked = [a for a in question.atoms if a in {*rest, *audited}]
        if not asked:
            self.tally.note(look, [str(a) for a in told], [], [], None)
            return written(request.text, lines)
        smaller = about(request, asked)
        if request.review is not None:
            smaller = replace(smaller, review=_reviewing(request, lines))
        answer = self._asked(smaller, lines)
        if self.leans:  # the asker takes probabilities for measured, which a large model's own are not
            answer = replace(answer, tokens=())
        checks = self._checks(answer, audited, readings)
        self.tally.note(look, [str(a) for a in told], [str(a) for a in rest], checks, smaller.key(self.model.name))
        return merged(answer, lines)

    def leaning(self) -> Cascade:
        """See ``Leaning``."""
        return replace(self, leans=True)

    def _leant(
        self, request: Request, question: LabelQuestion, readings: Mapping[int, Mapping[AskedAtom, AtomReading]]
    ) -> list[AskedAtom]:
        """The atoms that are told without being sure.

        Probabilities have no place in histories, nor in JSON, in which all is told when something is asked.
        """
        if not self.leans or not readings or request.purpose == Purpose.HISTORY:
            return []
        doubtful = [a for a in question.atoms if any(r[a].value is None for r in readings.values())]
        leant = [a for a in doubtful if all(r[a].why in _LEANT for r in readings.values())]
        return leant if leant == doubtful or not request.schema else []

    def stop(self) -> None:
        """End all waiting of the large model."""
        if isinstance(self.model, Stoppable):
            self.model.stop()

    def _asked(self, request: Request, lines: Sequence[Line]) -> Answer:
        """The large model's answer; an empty one where it gives none, so that what was read is kept."""
        try:
            answer = self.model.answer(request)
        except NoAnswerError:
            if not lines:
                raise
            return Answer("")
        return Answer("", answer.stored, spent=answer.spent) if lines and answer.finish == Finish.REFUSED else answer

    def _checks(
        self, answer: Answer, audited: Sequence[AskedAtom], readings: Mapping[int, Mapping[AskedAtom, AtomReading]]
    ) -> list[Checked]:
        """What the large model says about sure answers in the latest state."""
        latest = readings[max(readings)] if audited else {}
        said = self.said_of(answer.text, [str(a) for a in audited]) if audited else {}
        error = {(doc.word, len(doc.kinds)): doc.teacher_error for doc in self.reader.card.words}
        found = []
        for atom in audited:
            reading = latest[atom]
            if str(atom) in said and reading.value is not None:
                wrong = min(reading.probability, 1 - reading.probability)
                expected = wrong + error.get((atom.word, len(atom.names)), 0.0)
                found.append(Checked(str(atom), expected, reading.value, said[str(atom)]))
        return found


def leaning(reading: AtomReading) -> AtomReading:
    """The reading with the likelier value where it is not sure of it."""
    return replace(reading, value=reading.probability > 0.5) if reading.why == Why.UNSURE else reading


def _name_of(question: LabelQuestion) -> str:
    return "|".join(p.image.digest for look in question.looks.values() for p in look.pictures)


def _reviewing(request: Request, lines: Sequence[Line]) -> Callable[[str], Any]:
    review = request.review
    assert review is not None, "there is something to pass on"
    return lambda text: review(merged(Answer(text), lines).text)


def merged(answer: Answer, lines: Sequence[Line]) -> Answer:
    """The large model's answer with the reader's lines after it, or among its values where it is JSON."""
    if not lines or answer.finish in (Finish.CUT_SHORT, Finish.TOO_LARGE):
        return answer
    if (document := _json_of(answer.text)) is not None:
        return replace(answer, text=json.dumps(_with_rows(document, lines)), tokens=())
    between = "\n" if answer.text and not answer.text.endswith("\n") else ""
    own = written("", lines)
    pieces = answer.tokens if "".join(t.text for t in answer.tokens) == answer.text else (Token(answer.text, ()),)
    return replace(
        answer,
        text=answer.text + between + own.text,
        tokens=(*pieces, Token(between, ()), *own.tokens),
    )


def _json_of(text: str) -> Any:
    """The JSON document that an answer is, fences and sentences around it aside; ``None`` for prose."""
    for opening, closing in (("{", "}"), ("[", "]")):
        first, last = text.find(opening), text.rfind(closing) + 1
        try:
            found = json.loads(text[first:last] if 0 <= first < last else "")
        except (ValueError, RecursionError):
            continue
        if isinstance(found, dict | list):
            return found
    return None


def _with_rows(document: Any, lines: Sequence[Line]) -> Any:
    """The document with a row more for each line, where readers of such answers look for them."""
    rows = []
    for line in lines:
        atom, _, rest = line.text.removeprefix("* ").partition(": ")
        value, _, why = rest.partition(". ")
        rows.append({"atom": atom, "explanation": why, "value": value})
    if isinstance(document, list):
        return [*document, *rows]
    values = document.get("values")
    return document | {"values": [*values, *rows] if isinstance(values, list) else rows}
