"""YAML as plain data together with the line of every entry.

Read as the core schema of YAML 1.2 says (``On``, ``no`` and dates are text), narrowed to what a person writes by hand:
no tags, anchors or aliases, and bounds on size and depth, so that no file can blow up in memory.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import yaml

from pix2pred.system.errors import Pix2predError

MAX_BYTES = 8_000_000
MAX_ENTRIES = 200_000
MAX_DEPTH = 20

Loc = tuple[str | int, ...]
"""A place in a document: keys and list positions from the top, ``("states", 3, "given", 0)``."""

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_TAB_INDENT = re.compile(r" *\t")
_INT = re.compile(r"[-+]?[0-9]+\Z")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_CONSTANTS: Mapping[str, object] = {
    "": None, "~": None, "null": None, "Null": None, "NULL": None,
    "true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False,
    ".nan": float("nan"), ".inf": float("inf"), "+.inf": float("inf"), "-.inf": float("-inf"),
}  # fmt: skip


class YamlError(Pix2predError, ValueError):
    """Text that is not YAML as read here; ``line`` counts from 1."""

    def __init__(self, line: int, message: str) -> None:
        self.line = line
        self.message = message
        super().__init__(f"line {line}: {message}")


@dataclass(frozen=True, slots=True)
class LinedData:
    """Plain data (dict, list, str, int, float, bool, None) and the line where each entry starts."""

    data: Any
    lines: Mapping[Loc, int]

    def line(self, loc: Loc) -> int:
        """The line of ``loc``; parts that are not in the file, such as a missing key, are passed over."""
        found: Loc = ()
        for part in loc:
            if (*found, part) in self.lines:
                found = (*found, part)
        return self.lines[found]


def parse_yaml(content: bytes) -> LinedData:
    """Read one document. Raises ``YamlError`` with the line of whatever is wrong."""
    if len(content) > MAX_BYTES:
        raise YamlError(1, f"the file has {len(content)} bytes; more than {MAX_BYTES} are not read")
    builder = _Builder()
    for event in _events(_decode(content)):
        builder.take(event)
    if not builder.documents:
        raise YamlError(1, "the file is empty")
    return LinedData(builder.root, builder.lines)


def _decode(content: bytes) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise YamlError(line, "the file is not UTF-8 text; save it with the encoding UTF-8") from error


def _events(text: str) -> Iterator[Any]:
    try:
        yield from yaml.parse(text, Loader=_LOADER)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        problem = error.problem or "cannot be read"
        hint = ""
        if "invalid Unicode character escape" in problem:
            problem = "\\uD800 to \\uDFFF are halves of characters, and no text holds half of one"
            hint = " (write the character itself, or \\U and eight digits)"
        elif mark and any(_TAB_INDENT.match(line) for line in text.split("\n")[mark.line : mark.line + 1]):
            hint = " (indent with spaces, not tabs)"
        elif "mapping values are not allowed" in problem:
            hint = " (put text with a colon in quotes)"
        raise YamlError(mark.line + 1 if mark else 1, f"not valid YAML: {problem}{hint}") from error
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1 if isinstance(error.position, int) else 1
        raise YamlError(line, f"not valid YAML: {error.reason}") from error


@dataclass(slots=True)
class _Frame:
    container: list[Any] | dict[str, Any]
    loc: Loc
    key: str | None = None


@dataclass(slots=True)
class _Builder:
    """Builds data from parser events with its own stack: deep nesting must not exhaust Python's."""

    root: Any = None
    documents: int = 0
    lines: dict[Loc, int] = field(default_factory=lambda: {(): 1})
    stack: list[_Frame] = field(default_factory=list)

    def take(self, event: Any) -> None:
        """Add what one parser event says."""
        line = event.start_mark.line + 1
        match event:
            case yaml.DocumentStartEvent():
                self.documents += 1
                if self.documents > 1:
                    raise YamlError(line, "the file holds several documents; remove the separator '---'")
            case yaml.AliasEvent():
                raise YamlError(line, "aliases (*name) are not accepted; write the value out")
            case yaml.ScalarEvent():
                self._refuse_extras(event, line)
                self._scalar(event, line)
            case yaml.SequenceStartEvent() | yaml.MappingStartEvent():
                self._refuse_extras(event, line)
                self._open([] if isinstance(event, yaml.SequenceStartEvent) else {}, line)
            case yaml.SequenceEndEvent() | yaml.MappingEndEvent():
                self.stack.pop()
            case _:
                pass

    def _refuse_extras(self, event: Any, line: int) -> None:
        if event.anchor is not None:
            raise YamlError(line, f"anchors (&{event.anchor}) are not accepted; write the value out where it is used")
        if event.tag is not None:
            raise YamlError(line, f"tags ({event.tag}) are not accepted; put text in quotes instead")

    def _open(self, container: list[Any] | dict[str, Any], line: int) -> None:
        if self.stack and isinstance(self.stack[-1].container, dict) and self.stack[-1].key is None:
            raise YamlError(line, "a key must be text, not a list or a mapping")
        if len(self.stack) >= MAX_DEPTH:
            raise YamlError(line, f"entries are nested more than {MAX_DEPTH} deep")
        self.stack.append(_Frame(container, self._place(container, line)))

    def _scalar(self, event: Any, line: int) -> None:
        frame = self.stack[-1] if self.stack else None
        if frame is not None and isinstance(frame.container, dict) and frame.key is None:
            key: str = event.value
            if key in frame.container:
                first = self.lines[(*frame.loc, key)]
                raise YamlError(line, f"key {key!r} is given twice (first on line {first})")
            frame.key = key
            self.lines[(*frame.loc, key)] = line
        else:
            self._place(_plain_value(event.value, line) if event.implicit[0] else event.value, line)

    def _place(self, value: Any, line: int) -> Loc:
        """Put ``value`` where the parser is; returns its place."""
        if len(self.lines) > MAX_ENTRIES:
            raise YamlError(line, f"the file has more than {MAX_ENTRIES} entries")
        if not self.stack:
            self.root = value
            self.lines[()] = line
            return ()
        frame = self.stack[-1]
        if isinstance(frame.container, list):
            loc: Loc = (*frame.loc, len(frame.container))
            frame.container.append(value)
            self.lines[loc] = line
        else:
            assert frame.key is not None, "a value follows its key"
            loc = (*frame.loc, frame.key)
            frame.container[frame.key] = value
            frame.key = None
        return loc


def _plain_value(text: str, line: int) -> object:
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if _INT.match(text):
        if len(text) > 100:
            raise YamlError(line, "a number has more than 100 digits")
        return int(text)
    return float(text) if _FLOAT.match(text) else text
