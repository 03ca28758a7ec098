"""Labels as JSON: the schema a model is asked to follow, and its answer turned into the usual text."""

from __future__ import annotations

import ast
import json
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any


def schema(texts: Sequence[str]) -> str:
    """A JSON Schema for the values of the atoms ``texts``, as JSON text; thinking comes before the values."""
    words = {"type": "string", "enum": ["True", "False", "Unknown"]}
    row = {"atom": {"type": "string", "enum": list(texts)}, "explanation": {"type": "string"}, "value": words}
    fields = {
        "expected_changes": {"type": "string"},
        "observed_changes": {"type": "string"},
        "values": {"type": "array", "items": _object(row)},
    }
    return json.dumps(_object(fields), sort_keys=False)


def _object(fields: dict[str, object]) -> dict[str, object]:
    return {"type": "object", "properties": fields, "required": list(fields), "additionalProperties": False}


_ATOM_NAMES, _VALUE_NAMES = ("atom", "predicate", "name"), ("value", "label", "truth", "answer")
"""Keys under which models put an atom and its value when they make up a form of their own."""
_BARE = re.compile(r"(?<=[:,\[{ ])(?:true|false)(?=\s*[,\]}])")
"""Words of JSON that Python writes with a capital."""
_SHORT = 100_000
"""Characters beyond which a document is read as JSON alone."""
PAST = re.compile(r"\W*(?:before|previous\w*|old|earlier|initial\w*|expected|prior)(?:\b|_)", re.IGNORECASE)
"""Names of columns and parts that hold no present values."""
_ARGUMENTS = ("args", "arguments", "objects", "parameters")
_DEEPEST = 6
"""Levels of nesting that are looked into."""


def as_text(answer: str) -> str:
    """The answer with one line per value, as if it had been given in words; unchanged when no JSON in it has values.

    Many servers take a schema without a word and answer in prose: that is read as prose. JSON in a fence, between
    sentences or line by line is read, and so are a list of rows, an object from atoms to values, and lists of the atoms
    that are true and false. An atom with two values has none; parts that tell the state before are passed over.
    """
    document = _json_in(answer)
    rows = list(_rows(document, 0))
    values = Counter(atom for atom, _ in {(atom, value.lower()) for atom, value, _ in rows})
    rows = [row for row in rows if values[row[0]] == 1]
    if not rows:
        return answer
    lines = [f"* {atom}: {value}. {' '.join(why.split())}" for atom, value, why in rows]
    head = document if isinstance(document, dict) else {}
    flat = [" ".join(str(head.get(name, "")).split()) for name in ("expected_changes", "observed_changes")]
    return "\n".join([f"1. Expected changes: {flat[0]}", f"2. Observed changes: {flat[1]}", "3. Values:", *lines])


def _json_in(answer: str) -> Any:
    """The JSON document that ``answer`` is or has in it, or the list of its lines' documents; else ``None``."""
    for opening, closing in (("", ""), ("{", "}"), ("[", "]")):
        first, last = answer.find(opening), answer.rfind(closing) + len(closing)
        if first >= 0 and (found := _document(answer[first:last])) is not None:
            return found
    lines = [found for line in answer.splitlines() if line.lstrip()[:1] == "{" and (found := _document(line))]
    return lines or None


def _document(text: str) -> Any:
    """What ``text`` means as JSON or, where it is short, as Python or with commas at the end of lists."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        short = len(text) < _SHORT and "\\" not in text
        try:
            found = ast.literal_eval(_BARE.sub(lambda word: word[0].capitalize(), text)) if short else None
        except (ValueError, SyntaxError, RecursionError, MemoryError, TypeError):
            found = None
    return found if isinstance(found, dict | list) else None


def _rows(document: Any, depth: int) -> Iterator[tuple[str, str, str]]:
    """Atoms, their values and the explanations, wherever they stand in a document."""
    if depth > _DEEPEST:
        return
    if isinstance(document, list):
        for item in document:
            yield from _rows(item, depth + 1)
    elif isinstance(document, dict):
        atom = next((document[n] for n in _ATOM_NAMES if isinstance(document.get(n), str)), None)
        args = next((document[n] for n in _ARGUMENTS if isinstance(document.get(n), list)), None)
        if atom is not None and args is not None and "(" not in atom:
            atom = f"{atom}({', '.join(map(str, args))})"
        value = next((document[n] for n in _VALUE_NAMES if isinstance(document.get(n), str | int)), None)
        if atom is not None and value is not None:
            yield atom, _word(value), str(document.get("explanation", ""))
            return
        for name, inside in document.items():
            if "(" in str(name) and isinstance(inside, str | int):
                yield name, _word(inside), ""
            elif isinstance(inside, list) and str(name).lower() in ("true", "false", "unknown"):
                yield from ((atom, str(name), "") for atom in inside if isinstance(atom, str))
            elif "(" in str(name) and isinstance(inside, dict):
                yield from _rows({"atom": name} | inside, depth + 1)
            elif not PAST.match(str(name)):
                yield from _rows(inside, depth + 1)


def _word(value: str | int) -> str:
    return value if isinstance(value, str) else {0: "False", 1: "True"}.get(value, "?")
