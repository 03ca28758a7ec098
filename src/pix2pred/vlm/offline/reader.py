"""The offline reader: answers the same prompts as a hosted model, for the bundled domains, by reading pixels.

It is a set of small classifiers trained on renders of the domain, not a vision-language model. A label is a function
of the current picture's pixels, its boxes and the atom; the action and the previous answer serve only to repeat the
previous value of an object that has no box.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping, Sequence

from pix2pred.structs import Picture
from pix2pred.vlm.offline.label_question import LabelQuestion, Look
from pix2pred.vlm.offline.model import ReaderModel
from pix2pred.vlm.offline.pixels import Scene
from pix2pred.vlm.offline.prompt_format import (
    AskedAtom,
    KnownWord,
    definition_answer,
    history_line,
    label_answer,
    proposal_answer,
    value_line,
)
from pix2pred.vlm.request import Answer, Purpose, Request

_REMEMBERED_SCENES = 64


class OfflineReader:
    """Implements ``VLM``. ``name`` holds the digest of word list and weights, so stored answers know their reader."""

    def __init__(self, domain: str, model: ReaderModel) -> None:
        self.name = f"offline:{domain}:{model.digest[:12]}"
        self._model = model
        self._words = [
            KnownWord(word.word, types, word.concept or word.word, word.negated) for word, types in model.words.uses()
        ]
        self._scenes: OrderedDict[tuple[object, ...], Scene] = OrderedDict()
        self._lock = threading.Lock()

    def answer(self, request: Request) -> Answer:
        """Propose, define or label, as the prompt asks."""
        text = request.text
        if request.purpose == Purpose.PROPOSE:
            return Answer(proposal_answer(text, self._words))
        if request.purpose == Purpose.DEFINE:
            return Answer(definition_answer(text, self._words))
        question, history = LabelQuestion.of(request), request.purpose == Purpose.HISTORY
        seen = [(n, look, [self._scene(p, look.types) for p in look.pictures]) for n, look in question.looks.items()]
        lines = []
        for atom in question.atoms:
            value, why = question.before.get(str(atom)), ""
            values: dict[int, bool | None] = {}
            for number, look, scenes in seen:
                value, why = self._value(atom, look, scenes, value)
                values[number] = value
            lines.append(history_line(atom, values) if history else value_line(atom, value, why))
        return Answer("\n".join(lines) if history else label_answer(text, lines))

    def _value(
        self, atom: AskedAtom, look: Look, scenes: Sequence[Scene], before: bool | None
    ) -> tuple[bool | None, str]:
        """The value of ``atom`` in a state and what it rests on; ``before`` is its value in the state before."""
        hidden = [n for n in atom.names if all(scene.box(n) is None for scene in scenes)]
        if hidden:
            return before, f"{hidden[0]} has no box in this picture; value as before."
        seeing = [scene for scene in scenes if all(scene.box(n) is not None for n in atom.names)]
        read = self._model.joint_value(atom.word, atom.names, look.signature(atom.names), seeing)
        return read[0], f"Probability of True {read[1]:.2f}."

    def _scene(self, picture: Picture, types: Mapping[str, str]) -> Scene:
        """A picture, remembered while queries about the same state come in."""
        key = (picture.image.digest, *((n, b, types.get(n)) for n, b in sorted(picture.boxes.items())))
        with self._lock:
            if key not in self._scenes:
                self._scenes[key] = self._model.words.scene(picture, types)
                if len(self._scenes) > _REMEMBERED_SCENES:
                    self._scenes.popitem(last=False)
            return self._scenes[key]
