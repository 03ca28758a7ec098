"""The syntax of PDDL: nested lists of words that remember where they stand, and typed lists."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pix2pred.system.errors import Pix2predError

_TOKEN = re.compile(r";[^\n]*|\n|[^\S\n]+|[()]|\??[^\s();?]+|\?")
_MAX_DEPTH = 50


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A line and a column of a text, both counted from 1."""

    line: int
    column: int


class PddlError(Pix2predError, ValueError):
    """A text that is not PDDL of the supported kind; the message starts with line and column."""

    def __init__(self, place: Place, message: str) -> None:
        shown = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in message)
        super().__init__(f"line {place.line}, column {place.column}: {shown}")


@dataclass(frozen=True, slots=True)
class Word:
    """A symbol and where it begins."""

    text: str
    at: Place


@dataclass(frozen=True, slots=True)
class Group:
    """A list in parentheses.

    ``at`` is the place of the opening one.
    """

    items: tuple[Word | Group, ...]
    at: Place

    @property
    def head(self) -> str:
        """The first word, or an empty text."""
        return self.items[0].text if self.items and isinstance(self.items[0], Word) else ""


Node = Word | Group


def parse(text: str) -> Group:
    """The one list a PDDL file holds, in lower case. Raises ``PddlError``."""
    stack: list[tuple[list[Node], Place]] = []
    line, line_start = 1, 0
    done: Group | None = None
    at = Place(1, 1)
    for match in _TOKEN.finditer(text):
        token = match[0]
        at = Place(line, match.start() - line_start + 1)
        if token == "\n":
            line, line_start = line + 1, match.end()
            at = Place(line, 1)
        elif token == "(":
            if done is not None:
                raise PddlError(at, "text after the end of the definition")
            if len(stack) > _MAX_DEPTH:
                raise PddlError(at, f"parentheses are nested more than {_MAX_DEPTH} deep")
            stack.append(([], at))
        elif token == ")":
            if not stack:
                raise PddlError(at, "a closing parenthesis too many")
            items, opened = stack.pop()
            group = Group(tuple(items), opened)
            if stack:
                stack[-1][0].append(group)
            else:
                done = group
        elif not token.isspace() and not token.startswith(";"):
            if not stack:
                raise PddlError(at, f"{token!r} stands outside all parentheses")
            if not token.isprintable():
                raise PddlError(at, f"{token} holds a character that cannot be shown")
            stack[-1][0].append(Word(token.lower(), at))
    if stack:
        raise PddlError(stack[-1][1], "this parenthesis is never closed")
    if done is None:
        raise PddlError(at, "the file is empty")
    return done


@dataclass(frozen=True, slots=True)
class TypedWord:
    """A name of a typed list with the types it may have: several with ``either``, ``object`` when none is given."""

    name: Word
    types: tuple[Word, ...]


def typed_list(items: Sequence[Node]) -> Iterator[TypedWord]:
    """The names of a typed list. Raises ``PddlError``."""
    pending: list[Word] = []
    words = iter(items)
    for item in words:
        word = as_word(item)
        if word.text != "-":
            pending.append(word)
            continue
        type_item = next(words, None)
        if type_item is None:
            raise PddlError(word.at, "a type is missing after '-'")
        if isinstance(type_item, Group) and type_item.head == "either":
            types = tuple(as_word(i) for i in type_item.items[1:])
            if not types:
                raise PddlError(type_item.at, "(either ...) takes the names of types")
        else:
            types = (as_word(type_item),)
        yield from (TypedWord(name, types) for name in pending)
        pending = []
    yield from (TypedWord(name, (Word("object", name.at),)) for name in pending)


def as_word(node: Node) -> Word:
    """``node``, which must be a word."""
    if isinstance(node, Group):
        raise PddlError(node.at, "expected a name, found a parenthesis")
    return node


def as_group(node: Node) -> Group:
    """``node``, which must be a list."""
    if isinstance(node, Word):
        raise PddlError(node.at, f"expected a parenthesis, found {node.text}")
    return node
