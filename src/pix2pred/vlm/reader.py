"""The offline reader: answers the same prompts as a hosted model, for the bundled domains, by reading pixels.

It is a set of small classifiers trained on renders of the domain, not a vision-language model. A label is a function
of the current picture's pixels, its boxes and the atom; the action and the previous answer serve only to repeat the
previous value of an object that has no box.
"""

from __future__ import annotations

import re
import threading
from collections import OrderedDict
from collections.abc import Iterator, Sequence

from pix2pred.structs.views import View
from pix2pred.vlm.pixels import Scene
from pix2pred.vlm.reader_model import ReaderModel
from pix2pred.vlm.request import Answer, Request

_OBJECT_LINE = re.compile(r"^- (\S+) \(([^()\s]+)\)$", re.MULTILINE)
_ATOM_LINE = re.compile(r"^([A-Za-z_]\w*)\(([^()]*)\)$")
_PREVIOUS = re.compile(r"<previous>\n(.*?)\n</previous>", re.DOTALL)
_VALUE_LINE = re.compile(r"^[* ]*([A-Za-z_]\w*\([^()]*\)): (True|False|Unknown)\b", re.MULTILINE)
_REMEMBERED_SCENES = 64


class OfflineReader:
    """Implements ``VLM``. ``name`` holds the digest of word list and weights, so stored answers know their reader."""

    def __init__(self, domain: str, model: ReaderModel) -> None:
        self.name = f"offline:{domain}:{model.digest[:12]}"
        self._model = model
        self._scenes: OrderedDict[tuple[object, ...], Scene] = OrderedDict()
        self._lock = threading.Lock()

    def answer(self, request: Request) -> Answer:
        """Propose or label, as the prompt asks."""
        types = dict(_OBJECT_LINE.findall(request.text))
        if request.purpose == "propose":
            return Answer("\n".join(self._propose(types)))
        return Answer(self._label(request, types))

    def _propose(self, types: dict[str, str]) -> Iterator[str]:
        """One line per word and type signature, with synonyms and antonyms under the concept they belong to."""
        yield "Predicates that describe the scene, with synonyms and antonyms."
        seen: set[tuple[object, ...]] = set()
        for word, signature in self._model.words.uses():
            example = _example(types, signature)
            group = (word.concept or word.word, signature)
            if example is None or group in seen:
                continue
            seen.add(group)
            related = [w for w, s in self._model.words.uses() if (w.concept or w.word, s) == group]
            args = ", ".join(example)
            yield f"* {related[0].word}({args})"
            for title, negated in (("Synonyms", related[0].negated), ("Antonyms", not related[0].negated)):
                words = [f"{w.word}({args})" for w in related[1:] if w.negated == negated]
                if words:
                    yield f"  {title}: {', '.join(words)}"
        yield "In general: on(x, y) means that x rests on y."

    def _label(self, request: Request, types: dict[str, str]) -> str:
        listed = request.text.rpartition("\nPredicates:\n")[2].splitlines()
        previous = _previous_values(request.text)
        scenes = [self._scene(view) for view in _current(request.views)]
        lines = []
        for line in listed:
            if match := _ATOM_LINE.match(line.strip()):
                names = [n.strip() for n in match[2].split(",")]
                lines.append(self._label_line(match[1], names, types, scenes, previous))
        if "<previous>" not in request.text:
            return "\n".join(lines)
        values = "\n".join(lines)
        return (
            "1. Expected changes: not considered; this reader only looks at the picture.\n"
            "2. Observed changes: see the values.\n"
            f"3. Values:\n{values}"
        )

    def _label_line(
        self, word: str, names: Sequence[str], types: dict[str, str], scenes: Sequence[Scene], previous: dict[str, str]
    ) -> str:
        atom = f"{word}({', '.join(names)})"
        hidden = [n for n in names if all(scene.box(n) is None for scene in scenes)]
        if hidden:
            value = previous.get(atom, "Unknown")
            return f"* {atom}: {value}. {hidden[0]} has no box in this picture; value as before."
        signature = [types.get(n, "") for n in names]
        best: tuple[bool | None, float] = (None, 0.5)
        for scene in scenes:
            if all(scene.box(n) is not None for n in names):
                read = self._model.value(word, names, signature, scene)
                best = max(best, read, key=lambda r: abs(r[1] - 0.5))
        word_for = {True: "True", False: "False", None: "Unknown"}
        return f"* {atom}: {word_for[best[0]]}. Probability of True {best[1]:.2f}."

    def _scene(self, view: View) -> Scene:
        """The picture of a view, remembered while queries about the same state come in."""
        key = (view.picture.image.digest, *((n, b) for n, b in view.boxes.items()))
        with self._lock:
            if key not in self._scenes:
                self._scenes[key] = Scene(view.picture)
                if len(self._scenes) > _REMEMBERED_SCENES:
                    self._scenes.popitem(last=False)
            return self._scenes[key]


def _example(types: dict[str, str], signature: Sequence[str]) -> list[str] | None:
    """The first distinct objects of the signature's types, or None when the scene lacks one."""
    chosen: list[str] = []
    for wanted in signature:
        fitting = [n for n, t in types.items() if t == wanted and n not in chosen]
        if not fitting:
            return None
        chosen.append(fitting[0])
    return chosen


def _current(views: Sequence[View]) -> list[View]:
    """The uncropped pictures of the latest state."""
    whole = [v for v in views if v.crop is None]
    latest = max((v.state for v in whole), default=0)
    return [v for v in whole if v.state == latest]


def _previous_values(text: str) -> dict[str, str]:
    match = _PREVIOUS.search(text)
    return dict(_VALUE_LINE.findall(match[1])) if match else {}
