"""A labelling question as a reader takes it: atoms, what was said before, and a look at every state it is about."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from pix2pred.structs.views import View
from pix2pred.vlm.distilled.looks import Look
from pix2pred.vlm.offline.prompt_format import (
    AskedAtom,
    asked_atoms,
    current_views,
    object_types,
    previous_values,
    states_shown,
)
from pix2pred.vlm.request import Part, Purpose, Request

_LIST = "\nPredicates:\n"
_WORDS = {"True": True, "False": False}
LABELLING = frozenset({Purpose.LABEL, Purpose.DOUBLE_CHECK, Purpose.HISTORY})
"""Questions about labels that a reader answers. One that is asked again wants another opinion than it has."""


@dataclass(frozen=True, slots=True)
class LabelQuestion:
    """``looks`` are the states by number; only the latest counts unless the question is about a history."""

    atoms: tuple[AskedAtom, ...]
    before: Mapping[str, bool]
    looks: Mapping[int, Look]

    @classmethod
    def of(cls, request: Request) -> LabelQuestion:
        """What a request asks."""
        text = request.text
        types = object_types(text)
        shown: Mapping[int, Sequence[View]] = states_shown(request.views)
        if request.purpose != Purpose.HISTORY:
            latest = current_views(request.views)
            shown = {latest[0].state: latest} if latest else {}
        looks = {n: Look(tuple(view.picture for view in views), types) for n, views in shown.items()}
        said = {atom: _WORDS[word] for atom, word in previous_values(text).items() if word in _WORDS}
        return cls(tuple(asked_atoms(text)), said, looks)


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
