"""Goals as people write them: ``not``, ``and`` and ``or`` of atoms."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from itertools import product

from pix2pred.structs.goals.opposites import contrary
from pix2pred.structs.predicates import Application, Atom, parse_application

MAX_ALTERNATIVES = 16
"""Ways to reach a goal: there is one plan to look for in each."""

Literal = tuple[Application, bool]
"""What is written, and whether it is to hold or not to hold."""

_TOKEN = re.compile(
    r"\s*(?:(?P<word>(?:[Nn]ot|NOT|and|or)(?=[\s(]|\Z)|[!~\u00ac])|(?P<atom>[^\s()!~\u00ac]+\s*\([^()]*\))|(?P<paren>[()]))"
)


def parse_goals(texts: Sequence[str], atom: Callable[[Application], Atom]) -> tuple[tuple[Atom, ...], ...]:
    """The conjunctions of which one makes all ``texts`` true; ``atom`` says what a name with arguments stands for.

    A text is an atom, ``not``, ``and`` and ``or`` of such, and parentheses; ``or`` binds least. Raises ``ValueError``.
    """
    return combined([parse_goal(text) for text in texts], atom)


def combined(
    parts: Sequence[list[tuple[Literal, ...]]], atom: Callable[[Application], Atom]
) -> tuple[tuple[Atom, ...], ...]:
    """The conjunctions of which one makes each of ``parts`` true, without those that contradict themselves."""
    found: dict[tuple[Atom, ...], None] = {}
    for chosen in product(*parts):
        literals = [(atom(written), positive) for part in chosen for written, positive in part]
        atoms = tuple(dict.fromkeys(a if positive else contrary(a) for a, positive in literals))
        if not any(contrary(a) in atoms for a in atoms):
            found[atoms] = None
        if len(found) > MAX_ALTERNATIVES:
            raise ValueError(f"the goal can be reached in more than {MAX_ALTERNATIVES} ways; write it with fewer 'or'")
    if parts and not found:
        raise ValueError("the goal can never hold: it says of an atom that it must hold and must not hold")
    return tuple(found)


def parse_goal(text: str) -> list[tuple[Literal, ...]]:
    """The alternatives of one text. Raises ``ValueError`` that says where it is no goal."""
    return _Parser(text).parsed()


def shown(goals: Sequence[Sequence[Atom]]) -> list[str]:
    """``goals`` as texts that ``parse_goals`` reads: the atoms of one, or one text that names all."""
    if len(goals) == 1:
        return [str(atom) for atom in goals[0]]
    return [" or ".join(f"({' and '.join(map(str, goal))})" for goal in goals)]


class _Parser:
    """Reads ``not``, ``and`` and ``or`` by recursive descent, into alternatives of literals."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._tokens = list(self._tokenized())
        self._next = 0

    def parsed(self) -> list[tuple[Literal, ...]]:
        """The alternatives of the whole text."""
        found = self._any(positive=True)
        if self._next < len(self._tokens):
            raise self._error("'and' or 'or'")
        return found

    def _tokenized(self) -> Iterator[tuple[int, str]]:
        at = 0
        while at < len(self._text.rstrip()):
            match = _TOKEN.match(self._text, at)
            if match is None:
                parse_application(self._text[at:])
                raise ValueError(f"expected Name(object, ...), found {self._text[at:]!r}")
            yield at, match[0].strip()
            at = match.end()

    def _error(self, wanted: str) -> ValueError:
        if self._next >= len(self._tokens):
            return ValueError(f"expected {wanted} at the end of {self._text!r}")
        at, token = self._tokens[self._next]
        return ValueError(f"expected {wanted} in place of {token!r} at character {at + 1} of {self._text!r}")

    def _take(self, *wanted: str) -> bool:
        if self._next < len(self._tokens) and self._tokens[self._next][1].lower() in wanted:
            self._next += 1
            return True
        return False

    def _any(self, *, positive: bool) -> list[tuple[Literal, ...]]:
        parts = [self._all(positive=positive)]
        while self._take("or"):
            parts.append(self._all(positive=positive))
        return _either(parts) if positive else _both(parts)

    def _all(self, *, positive: bool) -> list[tuple[Literal, ...]]:
        parts = [self._one(positive=positive)]
        while self._take("and"):
            parts.append(self._one(positive=positive))
        return _both(parts) if positive else _either(parts)

    def _one(self, *, positive: bool) -> list[tuple[Literal, ...]]:
        if self._take("not", "!", "~", "\N{NOT SIGN}"):
            return self._one(positive=not positive)
        if self._take("("):
            found = self._any(positive=positive)
            if not self._take(")"):
                raise self._error("')'")
            return found
        if self._next >= len(self._tokens) or not self._tokens[self._next][1].endswith(")") or self._take(")"):
            raise self._error("an atom such as On(a, b), 'not' or '('")
        self._next += 1
        return [((parse_application(self._tokens[self._next - 1][1]), positive),)]


def _either(parts: Sequence[list[tuple[Literal, ...]]]) -> list[tuple[Literal, ...]]:
    return [alternative for part in parts for alternative in part]


def _both(parts: Sequence[list[tuple[Literal, ...]]]) -> list[tuple[Literal, ...]]:
    count = 1
    for part in parts:
        count *= len(part)
        if count > MAX_ALTERNATIVES**2:
            raise ValueError(f"the goal can be reached in more than {MAX_ALTERNATIVES} ways; write it with fewer 'or'")
    return [tuple(literal for alternative in chosen for literal in alternative) for chosen in product(*parts)]
