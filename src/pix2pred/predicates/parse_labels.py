"""Reading truth values out of a model's answer (method 3.6)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.predicates.parse_atoms import clean, mentions
from pix2pred.structs import FALSE, TRUE, UNKNOWN

_VALUE = re.compile(r"[ \t]*[:=][ \t]*([A-Za-z]+)")
_THIRD_SECTION = re.compile(r"^[ \t#>\-]*(?:section[ \t]*)?3[.):]", re.IGNORECASE | re.MULTILINE)
_WORDS = {"true": TRUE, "false": FALSE, "unknown": UNKNOWN}


@dataclass(frozen=True, slots=True)
class ParsedLabels:
    """The value of every queried atom that the answer gave one, and counts of what could not be used.

    ``other_words`` counts values that are neither True, False nor Unknown; ``unasked`` counts values for atoms that
    were not in the query; ``missing`` lists queried atoms without a value.
    """

    values: dict[str, int]
    missing: tuple[str, ...]
    other_words: int
    unasked: int


def parse_labels(answer: str, queried: Sequence[str]) -> ParsedLabels:
    """Read ``name(args): WORD`` lines; the last value of an atom wins.

    When the answer has a third section with values in it, only that section counts: the first two speak of expected
    and observed changes.
    """
    text = clean(answer)
    for heading in reversed(list(_THIRD_SECTION.finditer(text))):
        parsed = _parse(text[heading.end() :], queried)
        if parsed.values:
            return parsed
    return _parse(text, queried)


def _parse(text: str, queried: Sequence[str]) -> ParsedLabels:
    wanted = {_key(atom): atom for atom in queried}
    values: dict[str, int] = {}
    other_words = unasked = 0
    for mention in mentions(text):
        word = _VALUE.match(text, mention.end)
        if word is None:
            continue
        atom = wanted.get(_key(str(mention)))
        if atom is None:
            unasked += 1
        elif (value := _WORDS.get(word[1].lower())) is None:
            other_words += 1
        else:
            values[atom] = value
    missing = tuple(atom for atom in queried if atom not in values)
    return ParsedLabels(values, missing, other_words, unasked)


def _key(atom: str) -> str:
    """Equal for writings of an atom that differ in spaces, case or ``-`` for ``_``."""
    return re.sub(r"\s+", "", atom).replace("-", "_").lower()


def value_lines(values: dict[str, int]) -> str:
    """The bare ``atom: value`` lines of labels, in their order."""
    names = {TRUE: "True", FALSE: "False", UNKNOWN: "Unknown"}
    return "\n".join(f"{atom}: {names[value]}" for atom, value in values.items())
