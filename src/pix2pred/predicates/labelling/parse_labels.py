"""Reading truth values out of a model's answer (method 3.6)."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from pix2pred.predicates.proposing.parse_atoms import clean, kept, mentions
from pix2pred.structs import Label

_VALUE = re.compile(r"[ \t]*[:=][ \t]*([A-Za-z]+)")
_LINE_VALUE = re.compile(r"[\"'_ \t]*(?:[:=|：→]|->|=>|-|–|—)[\"'_ \t]*([A-Za-z]+)")
"""After an atom that begins a line, more is understood: quotes, arrows, dashes, table cells."""
_ATOM_AHEAD = r"(?![ \t]*[A-Za-z_][\w\-]*[ \t]*\([^()]*\)[ \t]*[:=])"
_THIRD_SECTION = re.compile(rf"^[ \t#>\-]*(?:section[ \t]*)?3[.):]{_ATOM_AHEAD}", re.IGNORECASE | re.MULTILINE)
_LINE_START = re.compile(r"\n[ \t>#+\-\d.)|\"'_•–]*\Z")
_WORDS: Mapping[str, Label] = {label.word: label for label in Label}


Value = TypeVar("Value")
"""What an answer says about an atom."""


@dataclass(frozen=True)  # no slots: a frozen generic class with slots cannot be made through ParsedLabels
class Parsed(Generic[Value]):
    """The value of every queried atom that the answer gave one, and counts of what could not be used.

    ``other_words`` counts values that are neither True, False nor Unknown; ``unasked`` counts values for atoms that
    were not in the query; ``missing`` lists queried atoms without a value; ``places`` says where in the answer the
    word stands that gave an atom its value; ``text`` is the answer as it was read.
    """

    values: dict[str, Value]
    missing: tuple[str, ...]
    other_words: int
    unasked: int
    places: dict[str, int] = field(default_factory=dict)
    text: str = ""


ParsedLabels = Parsed[Label]


@dataclass(frozen=True, slots=True)
class _Statement:
    """``atom: WORD`` at a place in the text; ``leads`` when its line begins with it, list markers aside."""

    atom: str
    word: str
    start: int
    word_start: int
    leads: bool


def parse_labels(answer: str, queried: Sequence[str]) -> ParsedLabels:
    """Read ``name(args): WORD`` lines.

    When the answer has a third section with values in it, only that section counts: the first two speak of expected
    and observed changes. The line that begins with an atom decides about it, the last such line if there are several;
    values inside explanations count only for atoms without a line of their own.
    """
    text = clean(answer)
    statements = list(_statements(text))
    if statements:
        begins = [h.end() for h in _THIRD_SECTION.finditer(text) if h.end() <= statements[-1].start]
        statements = [s for s in statements if s.start >= max(begins, default=0)]
    asked = QueriedAtoms(queried)
    inside: dict[str, tuple[Label, int]] = {}
    leading: dict[str, tuple[Label, int]] = {}
    other_words = unasked = 0
    for statement in statements:
        atom = asked.find(statement.atom)
        if atom is None:
            unasked += 1
        elif (value := _WORDS.get(statement.word.lower())) is None:
            other_words += 1
        else:
            (leading if statement.leads else inside)[atom] = value, statement.word_start
    found = inside | leading
    values = {atom: found[atom][0] for atom in queried if atom in found}
    raw = kept(answer) if values else []
    places = {atom: raw[found[atom][1]] for atom in values}
    return ParsedLabels(values, tuple(a for a in queried if a not in found), other_words, unasked, places, answer)


def _statements(text: str) -> Iterator[_Statement]:
    for mention in mentions(text):
        near = "\n" + text[: mention.start] if mention.start < 20 else text[mention.start - 20 : mention.start]
        leads = _LINE_START.search(near) is not None
        if word := (_LINE_VALUE if leads else _VALUE).match(text, mention.end):
            yield _Statement(str(mention), word[1], mention.start, word.start(1), leads)


class QueriedAtoms:
    """Queried atoms by their writing: as asked, or else whatever differs only in spaces, ``-`` for ``_``, and case."""

    def __init__(self, queried: Sequence[str]) -> None:
        self._plain = {_plain(atom): atom for atom in queried}
        folded = Counter(plain.lower() for plain in self._plain)
        self._folded = {p.lower(): atom for p, atom in self._plain.items() if folded[p.lower()] == 1}

    def find(self, text: str) -> str | None:
        """The queried atom that ``text`` writes, or none."""
        plain = _plain(text)
        return self._plain.get(plain) or self._folded.get(plain.lower())


def _plain(atom: str) -> str:
    return re.sub(r"\s+", "", atom).replace("-", "_")


def value_lines(values: Mapping[str, Label]) -> str:
    """The bare ``atom: value`` lines of labels, in their order."""
    return "\n".join(f"{atom}: {value.word.capitalize()}" for atom, value in values.items())
