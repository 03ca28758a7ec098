"""Which questions a distilled reader answers, and the same question about fewer atoms."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

from pix2pred.vlm.offline.prompt_format import AskedAtom
from pix2pred.vlm.request import Part, Purpose, Request

_LIST = "\nPredicates:\n"
LABELLING = frozenset({Purpose.LABEL, Purpose.DOUBLE_CHECK, Purpose.HISTORY})
"""Questions about labels that a reader answers. One that is asked again wants another opinion than it has."""


def about(request: Request, atoms: Sequence[AskedAtom]) -> Request:
    """The same question about ``atoms`` alone, in their order."""
    listed = "\n".join(map(str, atoms))
    parts: list[Part] = list(request.parts)
    place = max(i for i, part in enumerate(parts) if isinstance(part, str) and _LIST in part)
    text = parts[place]
    assert isinstance(text, str), "the place of a text"
    head, _, tail = text.rpartition(_LIST)
    ending = tail[len(tail.rstrip("\n")) :]
    parts[place] = f"{head}{_LIST}{listed}{ending}"
    return replace(request, parts=tuple(parts), schema=_schema_about(request.schema, [str(atom) for atom in atoms]))


def _schema_about(schema: str, atoms: Sequence[str]) -> str:
    """The JSON Schema with these atoms alone among those that can be given a value."""
    if not schema:
        return ""
    document = json.loads(schema)
    row = document.get("properties", {}).get("values", {}).get("items", {}).get("properties", {})
    if "enum" in row.get("atom", {}):
        row["atom"]["enum"] = list(atoms)
    return json.dumps(document, sort_keys=False)
