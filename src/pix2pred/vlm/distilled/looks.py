"""What a reader looks at: the pictures of one moment, with boxes and types of the objects in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pix2pred.structs import Picture


@dataclass(frozen=True, slots=True)
class Look:
    """The pictures of one state, one per camera, with boxes under the names of prompts, and the types of objects."""

    pictures: tuple[Picture, ...]
    types: Mapping[str, str]

    def signature(self, names: Sequence[str]) -> tuple[str, ...]:
        """The types of the objects called ``names``; an empty text stands for an object that is not known."""
        return tuple(self.types.get(name, "") for name in names)
