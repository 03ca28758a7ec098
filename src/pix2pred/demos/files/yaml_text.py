"""Plain data as YAML a person likes to read: one entry a line, lists of plain values inline; same data, same bytes."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

WIDTH = 110

_BARE = re.compile(r"[A-Za-z][A-Za-z0-9_\-]*\Z")
_NOT_TEXT = frozenset({"true", "false", "null", "yes", "no", "on", "off", "y", "n"})
"""Words that some YAML reader takes for a truth value or null; they are written in quotes."""
_UNPRINTABLE = re.compile("[\x7f-\x9f\u2028\u2029\ufeff\ufffe\uffff]")


def dump_yaml(data: Mapping[str, Any]) -> str:
    """YAML text of ``data``: mappings with text keys, sequences, text, numbers, truth values and None."""
    return "".join(f"{line}\n" for line in _block(data, ""))


def _block(value: Any, indent: str) -> Iterator[str]:
    """The lines of a container, one entry a line."""
    if isinstance(value, Mapping):
        for key, entry in value.items():
            yield from _entry(f"{indent}{_text(key)}:", entry, indent)
    else:
        for entry in value:
            if _is_leaf(entry):
                yield from _leaf(f"{indent}-", entry, indent)
            else:
                first, *rest = _block(entry, indent + "  ")
                yield f"{indent}- {first.lstrip(' ')}"
                yield from rest


def _entry(head: str, value: Any, indent: str) -> Iterator[str]:
    if _is_leaf(value) and not (isinstance(value, Mapping) and len(head) + len(inline_yaml(value)) >= WIDTH):
        yield from _leaf(head, value, indent)
    else:
        yield head
        # A list inside a mapping needs no further indentation.
        yield from _block(value, indent + "  " if isinstance(value, Mapping) else indent)


def _leaf(head: str, value: Any, indent: str) -> Iterator[str]:
    """``head value``; a list that is too long goes on in the next lines."""
    if not isinstance(value, (list, tuple)) or len(head) + len(inline_yaml(value)) < WIDTH:
        yield f"{head} {inline_yaml(value)}"
        return
    line = f"{head} ["
    for position, entry in enumerate(value):
        item = inline_yaml(entry) + ("]" if position == len(value) - 1 else ",")
        if position and len(line) + len(item) > WIDTH:
            yield line.rstrip(" ")
            line = f"{indent}    "
        line += f"{item} "
    yield line.rstrip(" ")


def _is_leaf(value: Any) -> bool:
    """Whether ``value`` is written inline: a plain value, or a container of plain values."""
    if isinstance(value, Mapping):
        return not any(_is_container(entry) for entry in value.values())
    return not _is_container(value) or not any(_is_container(entry) for entry in value)


def _is_container(value: Any) -> bool:
    return isinstance(value, (Mapping, list, tuple))


def inline_yaml(value: Any) -> str:
    """``value``, text or a container of values, on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_text(k)}: {inline_yaml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(inline_yaml(entry) for entry in value) + "]"
    match value:
        case None:
            return "null"
        case bool():
            return "true" if value else "false"
        case str():
            return _text(value)
        case int():
            return str(value)
        case float():
            return {"inf": ".inf", "-inf": "-.inf", "nan": ".nan"}.get(repr(float(value)), repr(float(value)))
        case _:
            raise TypeError(f"{value!r} of type {type(value).__name__} cannot be written as YAML")


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(f"key {value!r} is not text")
    if _BARE.match(value) and value.lower() not in _NOT_TEXT:
        return value
    quoted = json.dumps(value, ensure_ascii=False)
    return _UNPRINTABLE.sub(lambda found: f"\\u{ord(found[0]):04x}", quoted)
