"""A labelling question as a reader takes it: atoms, what was said before, and a look at every state it is about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pix2pred.structs import Picture
from pix2pred.structs.views import View
from pix2pred.vlm.offline.prompt_format import (
    AskedAtom,
    asked_atoms,
    current_views,
    object_types,
    previous_values,
    states_shown,
)
from pix2pred.vlm.request import Purpose, Request

_WORDS = {"True": True, "False": False}


@dataclass(frozen=True, slots=True)
class Look:
    """The pictures of one state, one per camera, with boxes under the names of prompts, and the types of objects."""

    pictures: tuple[Picture, ...]
    types: Mapping[str, str]

    def signature(self, names: Sequence[str]) -> tuple[str, ...]:
        """The types of the objects called ``names``; an empty text stands for an object that is not known."""
        return tuple(self.types.get(name, "") for name in names)


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
