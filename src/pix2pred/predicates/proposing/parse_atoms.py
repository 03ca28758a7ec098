"""Finding ground atoms in free text (method 2.2)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

LONGEST_NAME = 100
"""Characters of a proposed name; longer ones are no words, and with the number that a list of types adds they would be
longer than files of a run take."""
SHOWN = 200
"""Characters of an answer without any atom that a person is shown."""
_NAME = r"[A-Za-z_][A-Za-z0-9_\-]*"
_APPLICATION = re.compile(rf"(?<![A-Za-z0-9_\-])({_NAME})[ \t]*\(([^()]*)\)")
_ARGUMENT = re.compile(r"[A-Za-z0-9_\-]+(?: +[A-Za-z0-9_\-]+)*\Z")
_MARKUP = re.compile(r"[\\`*]")


@dataclass(frozen=True, slots=True)
class Mention:
    """``name(args)`` as found in a text.

    ``start`` and ``end`` number its first character and the one after its last in the cleaned text.
    """

    name: str
    args: tuple[str, ...]
    start: int
    end: int

    def __str__(self) -> str:
        return f"{self.name}({', '.join(self.args)})"


def clean(text: str) -> str:
    """Undo LaTeX and Markdown: backslashes, backticks and asterisks go, so ``\\_`` becomes ``_``."""
    return _MARKUP.sub("", text)


def kept(text: str) -> list[int]:
    """Where every character of ``clean(text)`` stands in ``text``."""
    return [i for i, character in enumerate(text) if character not in "\\`*"]


def mentions(cleaned: str) -> Iterator[Mention]:
    """Every ``identifier(name, name)`` in ``cleaned``, in order; ``p()`` and prose in brackets are passed over.

    Names are normalised: outer spaces go, inner ones collapse to one underscore, ``-`` becomes ``_``.
    """
    for match in _APPLICATION.finditer(cleaned):
        args = [" ".join(part.split()) for part in match[2].split(",")]
        if all(_ARGUMENT.match(a) for a in args):
            yield Mention(_normal(match[1]), tuple(_normal(a) for a in args), match.start(), match.end())


def _normal(name: str) -> str:
    return name.replace("-", "_").replace(" ", "_")
