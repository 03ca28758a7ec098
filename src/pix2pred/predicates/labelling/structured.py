"""Labels as JSON: the schema a model is asked to follow, and its answer turned into the usual text."""

from __future__ import annotations

import json
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
_DEEPEST = 6
"""Levels of nesting that are looked into."""


def as_text(answer: str) -> str:
    """The answer with one line per value, as if it had been given in words; unchanged when no JSON in it has values.

    Many servers take a schema without a word and answer in prose: that is read as prose. JSON in a fence or between
    sentences is read, and so are a list of rows and an object from atoms to values.
    """
    document = _json_in(answer)
    rows = list(_rows(document, 0))
    if not rows:
        return answer
    lines = [f"* {atom}: {value}. {' '.join(why.split())}" for atom, value, why in rows]
    head = document if isinstance(document, dict) else {}
    flat = [" ".join(str(head.get(name, "")).split()) for name in ("expected_changes", "observed_changes")]
    return "\n".join([f"1. Expected changes: {flat[0]}", f"2. Observed changes: {flat[1]}", "3. Values:", *lines])


def _json_in(answer: str) -> Any:
    """The JSON document that ``answer`` is or has in it; ``None`` when there is none."""
    for opening, closing in (("", ""), ("{", "}"), ("[", "]")):
        first, last = answer.find(opening), answer.rfind(closing) + len(closing)
        try:
            found = json.loads(answer[first:last] if first >= 0 else "")
        except (ValueError, RecursionError):
            continue
        if isinstance(found, dict | list):
            return found
    return None


def _rows(document: Any, depth: int) -> Iterator[tuple[str, str, str]]:
    """Atoms, their values and the explanations, wherever they stand in a document."""
    if depth > _DEEPEST:
        return
    if isinstance(document, list):
        for item in document:
            yield from _rows(item, depth + 1)
    elif isinstance(document, dict):
        atom = next((document[n] for n in _ATOM_NAMES if isinstance(document.get(n), str)), None)
        value = next((document[n] for n in _VALUE_NAMES if isinstance(document.get(n), str | bool)), None)
        if atom is not None and value is not None:
            yield atom, str(value), str(document.get("explanation", ""))
            return
        for name, inside in document.items():
            if "(" in name and isinstance(inside, str | bool):
                yield name, str(inside), ""
            elif "(" in name and isinstance(inside, dict):
                yield from _rows({"atom": name} | inside, depth + 1)
            else:
                yield from _rows(inside, depth + 1)
