"""Asking about atoms until each has a value (method 3.6): repetitions, splits, votes, confidence, and what is left.

An answer that leaves atoms out is followed by a query about those alone; one cut short by its token budget is thrown
away and its atoms are asked about in two halves. What still has no value is named with its reason.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from itertools import chain
from typing import Generic, Protocol

from pix2pred.predicates.labelling.parse_labels import Parsed, Value
from pix2pred.predicates.labelling.settings import LabelSettings
from pix2pred.predicates.prompt import atom_text
from pix2pred.structs import Atom
from pix2pred.vlm import VLM, Answer, Finish, NoAnswerError, Purpose, Request, Review, Together, Token
from pix2pred.vlm.request import Part


class Occurrence(StrEnum):
    """What is met while labels are asked for; how often is counted, and shown under these words."""

    READ = "answers read"
    """An answer that gave at least one value."""
    UNUSABLE = "unusable answers"
    UNANSWERED = "unanswered"
    REFUSED = "refused"
    CUT_SHORT = "cut short"
    OTHER_WORDS = "other words"
    """A value that is neither True, False nor Unknown."""
    UNASKED = "unasked"
    """A value of an atom that was not in the question."""
    MISSING = "missing"
    """An atom that no answer gave a value."""


TOKENS_PER_ATOM = 64
"""Answer tokens allowed for one atom: its text (about ten), its value, and a short explanation."""
TOKENS_OF_REASONING = 1024
"""Answer tokens allowed for what a model writes besides the values."""
_MORE = 4
"""How much larger the budget of a single atom grows when it was too small."""

MakeQuestion = Callable[[Sequence[Atom]], tuple[Part, ...]]
"""Text and pictures of a query about some atoms."""


@dataclass(frozen=True, slots=True)
class Gap:
    """Atoms, as texts, that got no value.

    ``about`` names demonstration and state, ``purpose`` the step that asked; ``reason`` is for people.
    """

    about: str
    purpose: Purpose
    atoms: tuple[str, ...]
    reason: str


class AnswerFormat(Protocol[Value]):
    """What a value is and how a model writes it: one label, or the labels of several states."""

    def read(self, answer: str, queried: Sequence[str]) -> Parsed[Value]:
        """What ``answer`` says about each of the atoms ``queried``, given as texts."""
        ...

    def schema(self, queried: Sequence[str]) -> str:
        """A JSON Schema that an answer should follow, as text; empty to ask for plain text."""
        ...

    def confidence(self, tokens: Sequence[Token], parsed: Parsed[Value]) -> dict[str, float]:
        """The probability of each value, by the text of its atom, where the answer's tokens tell it."""
        ...


@dataclass(slots=True)
class Asked(Generic[Value]):
    """What came of asking: values, their probabilities where known, the usable answers, counts, reasons of gaps.

    ``useless`` is the last answer from which nothing could be read.
    """

    values: dict[Atom, Value] = field(default_factory=dict)
    confidence: dict[Atom, float] = field(default_factory=dict)
    texts: list[str] = field(default_factory=list)
    counts: Counter[Occurrence] = field(default_factory=Counter)
    reasons: dict[Atom, str] = field(default_factory=dict)
    useless: str = ""

    def merge(self, other: Asked[Value]) -> None:
        """Add what ``other`` brought; atoms that now have a value lose their reason."""
        self.values |= other.values
        self.confidence |= other.confidence
        self.texts += other.texts
        self.counts += other.counts
        self.useless = other.useless or self.useless
        self.reasons = {a: r for a, r in (self.reasons | other.reasons).items() if a not in self.values}


@dataclass(frozen=True, slots=True)
class Asker(Generic[Value]):
    """Asks one question about a list of atoms. ``about`` names demonstration and state."""

    vlm: VLM
    settings: LabelSettings
    format: AnswerFormat[Value]
    together: Together
    purpose: Purpose
    question: MakeQuestion
    about: str

    def ask(self, atoms: Sequence[Atom]) -> Asked[Value]:
        """The values of ``atoms``: of one answer, or what the majority of ``votes`` samples says."""
        if not atoms:
            return Asked()
        samples = list(self.together.map(lambda n: self._sample(atoms, n), range(self.settings.votes)))
        return samples[0] if len(samples) == 1 else _majority(samples)

    def _sample(self, atoms: Sequence[Atom], sample: int) -> Asked[Value]:
        asked, pending = Asked[Value](), list(atoms)
        for attempt in range(self.settings.attempts):
            asked.merge(self._query(pending, sample, attempt))
            pending = [a for a in pending if a not in asked.values]
            if not pending or asked.counts[Occurrence.UNANSWERED]:  # asking again was tried already
                break
        return asked

    def _query(self, atoms: Sequence[Atom], sample: int, attempt: int, budget: int = 1) -> Asked[Value]:
        """One query, or several when the answer does not fit its budget."""
        texts = {a: atom_text(a) for a in atoms}
        request = self._request(atoms, list(dict.fromkeys(texts.values())), sample, attempt, budget)
        try:
            answer = self.vlm.answer(request)
        except NoAnswerError as error:
            return Asked(counts=Counter([Occurrence.UNANSWERED]), reasons=dict.fromkeys(atoms, f"no answer: {error}"))
        if answer.finish in (Finish.CUT_SHORT, Finish.TOO_LARGE):
            return self._smaller(atoms, sample, attempt, budget)
        if answer.finish == Finish.REFUSED:
            counts = Counter([Occurrence.REFUSED, Occurrence.UNUSABLE])
            return Asked(counts=counts, reasons=dict.fromkeys(atoms, "refused"), useless=answer.text)
        return self._read(answer, texts)

    def _smaller(self, atoms: Sequence[Atom], sample: int, attempt: int, budget: int) -> Asked[Value]:
        asked = Asked[Value](counts=Counter([Occurrence.CUT_SHORT]))
        if len(atoms) > 1:
            middle = len(atoms) // 2
            asked.merge(self._query(atoms[:middle], sample, attempt, budget))
            asked.merge(self._query(atoms[middle:], sample, attempt, budget))
        elif budget == 1:
            asked.merge(self._query(atoms, sample, attempt, _MORE))
        else:
            asked.merge(Asked(counts=Counter([Occurrence.UNUSABLE]), reasons=dict.fromkeys(atoms, "always cut short")))
        return asked

    def _read(self, answer: Answer, texts: dict[Atom, str]) -> Asked[Value]:
        parsed = self.format.read(answer.text, list(dict.fromkeys(texts.values())))
        values = {a: parsed.values[t] for a, t in texts.items() if t in parsed.values}
        counts = Counter({Occurrence.OTHER_WORDS: parsed.other_words, Occurrence.UNASKED: parsed.unasked})
        counts[Occurrence.READ if values else Occurrence.UNUSABLE] += 1
        sure = self.format.confidence(answer.tokens, parsed) if answer.tokens else {}
        return Asked(
            values,
            {a: sure[texts[a]] for a in values if texts[a] in sure},
            [parsed.text] if values else [],
            +counts,
            {a: "the answers hold no value for it" for a in texts if a not in values},
            "" if values else answer.text,
        )

    def _request(self, atoms: Sequence[Atom], texts: list[str], sample: int, attempt: int, budget: int) -> Request:
        settings = self.settings
        return Request(
            self.purpose,
            self.question(atoms),
            (TOKENS_OF_REASONING + TOKENS_PER_ATOM * len(texts)) * budget,
            temperature=settings.sampling_temperature,
            sample=sample,
            attempt=attempt,
            schema=self.format.schema(texts),
            logprobs=settings.logprobs,
            about=self.about,
            review=lambda answer: _review(self.format.read(answer, texts), texts),
        )

    def gaps(self, asked: Asked[Value]) -> tuple[Gap, ...]:
        """The atoms left without a value, grouped by reason."""
        reasons: dict[str, list[str]] = {}
        for atom, reason in asked.reasons.items():
            reasons.setdefault(reason, []).append(atom_text(atom))
        return tuple(Gap(self.about, self.purpose, tuple(sorted(t)), r) for r, t in sorted(reasons.items()))


def in_batches(atoms: Sequence[Atom], most: int | None) -> list[list[Atom]]:
    """``atoms`` in the order of their texts, at most so many together; all together when ``most`` is None or 0."""
    ordered = sorted(atoms, key=atom_text)
    size = most or max(1, len(ordered))
    return [ordered[i : i + size] for i in range(0, len(ordered), size)]


def _review(parsed: Parsed[Value], texts: Sequence[str]) -> Review | None:
    if not parsed.missing:
        return None
    listed = "\n".join(f"* {text}: VALUE" for text in parsed.missing)
    problem = f"No value (True, False or Unknown) could be read for {len(parsed.missing)} of {len(texts)} predicates:"
    return Review(f"{problem}\n\n{listed}", bool(parsed.values))


def _majority(samples: Sequence[Asked[Value]]) -> Asked[Value]:
    """What most samples say, atom by atom; the earliest decides a tie. Confidence is the share of all samples."""
    total = Asked[Value](counts=sum((s.counts for s in samples), Counter[Occurrence]()))
    for atom in dict.fromkeys(chain.from_iterable([*s.values, *s.reasons] for s in samples)):
        votes = Counter(s.values[atom] for s in samples if atom in s.values)
        if votes:
            total.values[atom], count = votes.most_common(1)[0]
            total.confidence[atom] = count / len(samples)
        else:
            total.reasons[atom] = next(s.reasons[atom] for s in samples if atom in s.reasons)
    agreeing = [sum(s.values.get(a) == v for a, v in total.values.items()) for s in samples]
    best = samples[agreeing.index(max(agreeing))]
    return replace(total, texts=best.texts, useless="" if total.values else best.useless)
