"""The syntax of PDDL: nested lists of words that remember their lines, and typed lists."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pix2pred.system.errors import Pix2predError

_TOKEN = re.compile(r";[^\n]*|\n|[^\S\n]+|[()]|[^\s();]+")
_MAX_DEPTH = 50


class PddlError(Pix2predError, ValueError):
    """A text that is not PDDL of the supported kind; the message starts with the line."""

    def __init__(self, line: int, message: str) -> None:
        shown = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in message)
        super().__init__(f"line {line}: {shown}")


@dataclass(frozen=True, slots=True)
class Word:
    """A symbol and the line it stands on."""

    text: str
    line: int


@dataclass(frozen=True, slots=True)
class Group:
    """A parenthesised list and the line it opens on."""

    items: tuple[Word | Group, ...]
    line: int

    @property
    def head(self) -> str:
        """The first word, or an empty text."""
        return self.items[0].text if self.items and isinstance(self.items[0], Word) else ""


def parse(text: str) -> Group:
    """The one list a PDDL file holds, in lower case. Raises ``PddlError``."""
    stack: list[tuple[list[Word | Group], int]] = []
    line = 1
    done: Group | None = None
    for token in _TOKEN.findall(text):
        if token == "\n":
            line += 1
        elif token == "(":
            if done is not None:
                raise PddlError(line, "text after the end of the definition")
            if len(stack) > _MAX_DEPTH:
                raise PddlError(line, f"parentheses are nested more than {_MAX_DEPTH} deep")
            stack.append(([], line))
        elif token == ")":
            if not stack:
                raise PddlError(line, "a closing parenthesis too many")
            items, opened = stack.pop()
            group = Group(tuple(items), opened)
            if stack:
                stack[-1][0].append(group)
            else:
                done = group
        elif not token.isspace() and not token.startswith(";"):
            if not stack:
                raise PddlError(line, f"{token!r} stands outside all parentheses")
            stack[-1][0].append(Word(token.lower(), line))
    if stack:
        raise PddlError(stack[-1][1], "this parenthesis is never closed")
    if done is None:
        raise PddlError(line, "the file is empty")
    return done


def typed_list(items: Sequence[Word | Group]) -> Iterator[tuple[Word, Word]]:
    """(name, type) pairs of a typed list; without a type it is ``object``."""
    pending: list[Word] = []
    words = iter(items)
    for item in words:
        word = as_word(item)
        if word.text != "-":
            pending.append(word)
            continue
        type_item = next(words, None)
        if type_item is None:
            raise PddlError(word.line, "a type is missing after '-'")
        if isinstance(type_item, Group) and type_item.head == "either":
            raise PddlError(type_item.line, "(either ...) is not supported; give the types a common parent")
        yield from ((name, as_word(type_item)) for name in pending)
        pending = []
    yield from ((name, Word("object", name.line)) for name in pending)


def as_word(node: Word | Group) -> Word:
    """``node``, which must be a word."""
    if isinstance(node, Group):
        raise PddlError(node.line, "expected a name, found a parenthesis")
    return node


def as_group(node: Word | Group) -> Group:
    """``node``, which must be a list."""
    if isinstance(node, Word):
        raise PddlError(node.line, f"expected a parenthesis, found {node.text}")
    return node
