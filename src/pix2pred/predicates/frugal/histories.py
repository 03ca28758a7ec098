"""Answers that hold the labels of several states: a first value, and the states in which it becomes another."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.predicates.labelling.parse_labels import Parsed, QueriedAtoms
from pix2pred.predicates.labelling.written_forms import without_markup
from pix2pred.predicates.proposing.parse_atoms import clean, mentions
from pix2pred.structs import Label
from pix2pred.vlm import Token

History = tuple[Label, ...]
"""The labels of one atom in successive states."""

_LABELS = {label.word: label for label in Label}
_TOKENS = re.compile(r"\d+|[A-Za-z]+")
_FILLERS = {"from", "in", "at", "state", "states", "on", "then", "value"}
"""Words between numbers and values that some models write."""


@dataclass(frozen=True, slots=True)
class HistoryFormat:
    """``atom: VALUE; N VALUE; ...`` for the states with these numbers, in their order."""

    states: tuple[int, ...]

    def read(self, answer: str, queried: Sequence[str]) -> Parsed[History]:
        """The last line that begins with an atom decides about it; a line that cannot be read gives no value."""
        asked, found = QueriedAtoms(queried), dict[str, History]()
        other_words = unasked = 0
        for line in clean(without_markup(answer)).splitlines():
            mention = next(mentions(line), None)
            if mention is None or any(character.isalpha() for character in line[: mention.start]):
                continue
            atom = asked.find(str(mention))
            if atom is None:
                unasked += 1
            elif (history := self._history(line[mention.end :])) is None:
                other_words += 1
            else:
                found[atom] = history
        values = {atom: found[atom] for atom in queried if atom in found}
        return Parsed(values, tuple(a for a in queried if a not in found), other_words, unasked, {}, answer)

    def schema(self, queried: Sequence[str]) -> str:
        return ""

    def confidence(self, tokens: Sequence[Token], parsed: Parsed[History]) -> dict[str, float]:
        return {}

    def _history(self, text: str) -> History | None:
        """The labels that a line gives, or none if it names a state that is not shown or a word that is no value."""
        words = [w for w in _TOKENS.findall(text.lower()) if w not in _FILLERS]
        if not words or words[0] not in _LABELS:
            return None
        value, rest = _LABELS[words[0]], words[1:]
        if len(rest) % 2:
            return None
        changes = {self.states[0]: value}
        for one, other in zip(rest[::2], rest[1::2], strict=True):
            number, word = (one, other) if one.isdigit() else (other, one)  # "3 True" or "True from state 3"
            if word not in _LABELS or not number.isdigit() or int(number) not in self.states:
                return None
            changes[int(number)] = _LABELS[word]
        labels = []
        for state in self.states:
            value = changes.get(state, value)
            labels.append(value)
        return tuple(labels)
