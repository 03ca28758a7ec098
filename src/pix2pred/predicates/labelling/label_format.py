"""Answers that hold one label per atom, in words or as JSON (method 3.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.predicates.labelling.confidence import probability
from pix2pred.predicates.labelling.parse_labels import ParsedLabels, parse_labels
from pix2pred.predicates.labelling.structured import as_text, schema
from pix2pred.structs import Label
from pix2pred.vlm import Token


@dataclass(frozen=True, slots=True)
class LabelFormat:
    """One label per atom; ``structured`` asks for JSON, and reads prose as well, which many servers give anyway."""

    structured: bool = False

    def read(self, answer: str, queried: Sequence[str]) -> ParsedLabels:
        parsed = parse_labels(as_text(answer) if self.structured else answer, queried)
        if parsed.values or self.structured:
            return parsed
        return parse_labels(as_text(answer), queried)  # JSON that nobody asked for

    def schema(self, queried: Sequence[str]) -> str:
        return schema(queried) if self.structured else ""

    def confidence(self, tokens: Sequence[Token], parsed: ParsedLabels) -> dict[str, float]:
        if "".join(token.text for token in tokens) != parsed.text:
            return {}  # the answer was JSON: places of the text made from it say nothing about its tokens
        sure: dict[str, Label] = parsed.values
        found = {text: probability(tokens, parsed.places[text], value) for text, value in sure.items()}
        return {text: p for text, p in found.items() if p is not None}
