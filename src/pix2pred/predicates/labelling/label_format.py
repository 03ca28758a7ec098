"""Answers that hold one label per atom, in words or as JSON (method 3.6)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pix2pred.predicates.labelling.parse_labels import ParsedLabels, parse_labels
from pix2pred.predicates.labelling.structured import as_text, schema
from pix2pred.predicates.labelling.written_forms import as_lines, without_markup
from pix2pred.structs import Label
from pix2pred.vlm import Token


@dataclass(frozen=True, slots=True)
class LabelFormat:
    """One label per atom; ``structured`` asks for JSON, and reads prose as well, which many servers give anyway."""

    structured: bool = False

    def read(self, answer: str, queried: Sequence[str]) -> ParsedLabels:
        """The values in ``answer``, as lines of words or, where these give none, in the first other form that does."""
        plain = without_markup(answer)
        readings = (parse_labels(form, queried) for form in self._forms(plain, queried))
        return next((parsed for parsed in readings if parsed.values), None) or parse_labels(plain, queried)

    def _forms(self, plain: str, queried: Sequence[str]) -> Iterator[str]:
        if not self.structured:
            yield plain
        yield as_text(plain)
        yield as_lines(plain, queried)

    def schema(self, queried: Sequence[str]) -> str:
        return schema(queried) if self.structured else ""

    def confidence(self, tokens: Sequence[Token], parsed: ParsedLabels) -> dict[str, float]:
        if "".join(token.text for token in tokens) != parsed.text:
            return {}  # the answer was JSON: places of the text made from it say nothing about its tokens
        sure: dict[str, Label] = parsed.values
        found = {text: probability(tokens, parsed.places[text], value) for text, value in sure.items()}
        return {text: p for text, p in found.items() if p is not None}


def probability(tokens: Sequence[Token], place: int, value: Label) -> float | None:
    """The probability of ``value`` among the three, at the token with which the value's word begins.

    ``place`` is where the word begins in the answer, whose text the tokens make up. ``None`` when no likely token
    there begins one of the three words.
    """
    start = 0
    for token in tokens:
        if start <= place < start + len(token.text):
            return _share(token, token.text[: place - start], value)
        start += len(token.text)
    return None


def _share(token: Token, before: str, value: Label) -> float | None:
    masses = dict.fromkeys(Label, 0.0)
    for text, logprob in dict(token.logprobs).items():
        begun = text.removeprefix(before).strip(" *`\"'").lower()
        for candidate in Label:
            word: str = candidate.word
            if begun and (word.startswith(begun) or begun.startswith(word)):
                masses[candidate] += math.exp(min(0.0, logprob))
    total = sum(masses.values())
    return masses[value] / total if total > 0 and masses[value] > 0 else None
