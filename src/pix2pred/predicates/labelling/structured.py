"""Labels as JSON: the schema a model is asked to follow, and its answer turned into the usual text."""

from __future__ import annotations

import json
from collections.abc import Sequence


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


def as_text(answer: str) -> str:
    """The answer with one line per value, as if it had been given in words; unchanged if it is not such JSON.

    Many servers take a schema without a word and answer in prose: that is read as prose.
    """
    try:
        document = json.loads(answer)
        rows = [(str(r["atom"]), str(r["value"]), str(r.get("explanation", ""))) for r in document["values"]]
        head = [str(document.get("expected_changes", "")), str(document.get("observed_changes", ""))]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return answer
    lines = [f"* {atom}: {value}. {' '.join(why.split())}" for atom, value, why in rows]
    flat = [" ".join(text.split()) for text in head]
    return "\n".join([f"1. Expected changes: {flat[0]}", f"2. Observed changes: {flat[1]}", "3. Values:", *lines])
