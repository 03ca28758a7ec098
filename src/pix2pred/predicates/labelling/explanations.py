"""What a model said about an atom besides its value: kept with the labels, for people to judge them by."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pix2pred.predicates.proposing.parse_atoms import clean, mentions

LONGEST = 400
"""Characters kept of one explanation."""

_VALUE = re.compile(r"[ \t]*[:=][ \t]*(?:true|false|unknown)\b[ \t.,;:*)–-]*", re.IGNORECASE)


def explanations(answer: str, queried: Sequence[str]) -> dict[str, str]:
    """The words with which ``answer`` explains each of ``queried``; atoms without any are left out.

    That is what follows the value on the atom's line or, failing that, the last other line that mentions the atom.
    """
    asked = {_plain(atom): atom for atom in queried}
    beside: dict[str, str] = {}
    elsewhere: dict[str, str] = {}
    for line in clean(answer).splitlines():
        for mention in mentions(line):
            atom = asked.get(_plain(str(mention)))
            if atom is None:
                continue
            if value := _VALUE.match(line, mention.end):
                if text := _shortened(line[value.end() :]):
                    beside[atom] = text
            elif text := _shortened(line.lstrip(" \t*-#>0123456789.)")):
                elsewhere[atom] = text
    return elsewhere | beside


def _plain(atom: str) -> str:
    return re.sub(r"\s+", "", atom).replace("-", "_").lower()


def _shortened(text: str) -> str:
    words = " ".join(text.split())
    return words if len(words) <= LONGEST else words[: LONGEST - 1] + "…"
