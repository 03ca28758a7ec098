"""Answers to the same question with other names of types: renaming a type in a project does not make them worthless.

Names of types stand in a question in five places: behind each object, in executed actions, in lists of more general
types, before what a type means, and in signatures of skills and predicates. Two questions are the same but for these
names when they agree once every type is called by its first object; lines may be in another order, since lists are
sorted by such names.
"""

from __future__ import annotations

import json
import re
import threading
from collections import defaultdict
from typing import Any

from pix2pred.system.files import read_regular
from pix2pred.vlm.answers.store import AnswerStore
from pix2pred.vlm.request import Request, key_of

_OBJECT = re.compile(r"^- (.+) \(([^()\s]+)\)$", re.MULTILINE)
_GENERAL = re.compile(r"^- (\w+): (\w+(?:, \w+)*)$", re.MULTILINE)
_MEANT = re.compile(r"(?<=^- )(\w+)(?= = )", re.MULTILINE)
_IN_ACTION = re.compile(r"(?<=:)(\w+)(?=[,\]])")
_SIGNATURE = re.compile(r"(?<=\w\()([^()]+)(?=\))")
_TYPES = re.compile(r"^(- \w+)(\([^()\n]*\)(?:, \([^()\n]*\))*)", re.MULTILINE)
"""A skill or a word with the types of its arguments, a list for each combination."""
_LIST = re.compile(r"\(([^()]*)\)")
_PIXELS = re.compile(rb'"pixels": "([0-9a-f]{64})"')


class RenamedQuestions:
    """What a store holds for questions that differ from others in names of types alone. Looks through it once."""

    def __init__(self, store: AnswerStore) -> None:
        self._store = store
        self._by_pictures: dict[tuple[str, ...], list[str]] | None = None
        self._lock = threading.Lock()

    def key(self, request: Request, model: str) -> str | None:
        """The key of such a question that is stored, the first in order; None without one."""
        pictures = tuple(view.picture.image.digest for view in request.views)
        if not pictures:  # all such questions would be looked through for each
            return None
        with self._lock:
            if self._by_pictures is None:
                self._by_pictures = self._look()
            candidates = self._by_pictures.get(pictures, [])
        if not candidates:
            return None
        canonical = request.canonical(model)
        own, wanted = key_of(canonical), _without_names(canonical)
        return next((key for key in candidates if key != own and self._stored(key) == wanted), None)

    def _look(self) -> dict[tuple[str, ...], list[str]]:
        """The keys of all stored questions by the pictures they show."""
        found: defaultdict[tuple[str, ...], list[str]] = defaultdict(list)
        for key in self._store.all_keys():
            try:
                shown = _PIXELS.findall(read_regular(self._store.path(key)))
            except OSError:  # said when somebody asks for that very answer
                continue
            found[tuple(digest.decode() for digest in shown)].append(key)
        return found

    def _stored(self, key: str) -> str | None:
        try:
            return _without_names(json.loads(read_regular(self._store.path(key)))["request"])
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return None


def _without_names(canonical: dict[str, Any]) -> str:
    """A key of the question ``canonical`` that does not depend on how types are called, nor on the order of lines."""
    texts = [part for part in canonical["parts"] if isinstance(part, str)]
    pictures = [part for part in canonical["parts"] if not isinstance(part, str)]
    return key_of({**canonical, "parts": pictures, "lines": sorted(_neutral("\n".join(texts)).splitlines())})


def _neutral(text: str) -> str:
    objects = dict(_OBJECT.findall(text))
    called: dict[str, str] = {}
    for name, kind in objects.items():
        called.setdefault(kind, f"<{name}>")

    def members(general: re.Match[str]) -> list[str]:
        return sorted(called.get(kind, kind) for kind in general[2].split(", "))

    def arguments(match: re.Match[str]) -> str:
        parts = (part.strip() for part in match[1].split(","))
        return ", ".join(part if part in objects else called.get(part, part) for part in parts)

    def signatures(match: re.Match[str]) -> str:
        """Types alone stand here, also those that are called like an object."""
        lists = ([called.get(t.strip(), t.strip()) for t in types.split(",")] for types in _LIST.findall(match[2]))
        return f"{match[1]} [{'; '.join(sorted(', '.join(types) for types in lists))}]"

    generals = [m for m in _GENERAL.finditer(text) if all(kind in called for kind in m[2].split(", "))]
    more = {m[1]: f"<{' '.join(members(m))}>" for m in generals if m[1] not in called}
    called |= more
    text = _OBJECT.sub(lambda m: f"- {m[1]} {called[m[2]]}", text)
    text = _GENERAL.sub(lambda m: f"- {called.get(m[1], m[1])}: {', '.join(members(m))}", text)
    text = _MEANT.sub(lambda m: called.get(m[1], m[1]), text)
    text = _IN_ACTION.sub(lambda m: called.get(m[1], m[1]), text)
    return _SIGNATURE.sub(arguments, _TYPES.sub(signatures, text))
