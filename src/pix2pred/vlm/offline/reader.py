"""The offline reader: answers the same prompts as a hosted model, for the bundled domains, by reading pixels.

It is a set of small classifiers trained on renders of the domain, not a vision-language model. A label is a function
of the current picture's pixels, its boxes and the atom; the action and the previous answer serve only to repeat the
previous value of an object that has no box.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence

from pix2pred.structs.views import View
from pix2pred.vlm.offline.model import ReaderModel
from pix2pred.vlm.offline.pixels import Scene
from pix2pred.vlm.offline.prompt_format import (
    AskedAtom,
    KnownWord,
    asked_atoms,
    current_views,
    definition_answer,
    history_line,
    label_answer,
    object_types,
    previous_values,
    proposal_answer,
    states_shown,
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
        if request.purpose == Purpose.HISTORY:
            return Answer("\n".join(self._histories(request)))
        types, previous = object_types(text), previous_values(text)
        scenes = [self._scene(view, types) for view in current_views(request.views)]
        lines = [self._label(atom, types, scenes, previous) for atom in asked_atoms(text)]
        return Answer(label_answer(text, lines))

    def _histories(self, request: Request) -> Iterator[str]:
        """A line per atom: its value in every state shown, an object without a box keeping its value."""
        text = request.text
        types, before = object_types(text), previous_values(text)
        states = {
            number: [self._scene(view, types) for view in shown]
            for number, shown in states_shown(request.views).items()
        }
        for atom in asked_atoms(text):
            said = {"True": True, "False": False}.get(before.get(str(atom), "Unknown"))
            values = {number: (said := self._value(atom, types, scenes, said)[0]) for number, scenes in states.items()}
            yield history_line(atom, values)

    def _label(
        self, atom: AskedAtom, types: Mapping[str, str], scenes: Sequence[Scene], previous: Mapping[str, str]
    ) -> str:
        before = {"True": True, "False": False}.get(previous.get(str(atom), "Unknown"))
        value, why = self._value(atom, types, scenes, before)
        return value_line(atom, value, why)

    def _value(
        self, atom: AskedAtom, types: Mapping[str, str], scenes: Sequence[Scene], before: bool | None
    ) -> tuple[bool | None, str]:
        """The value of ``atom`` in a state and what it rests on; ``before`` is its value in the state before."""
        hidden = [n for n in atom.names if all(scene.box(n) is None for scene in scenes)]
        if hidden:
            return before, f"{hidden[0]} has no box in this picture; value as before."
        signature = [types.get(n, "") for n in atom.names]
        seeing = [scene for scene in scenes if all(scene.box(n) is not None for n in atom.names)]
        read = self._model.joint_value(atom.word, atom.names, signature, seeing)
        return read[0], f"Probability of True {read[1]:.2f}."

    def _scene(self, view: View, types: Mapping[str, str]) -> Scene:
        """The picture of a view, remembered while queries about the same state come in."""
        key = (view.picture.image.digest, *((n, b, types.get(n)) for n, b in view.boxes.items()))
        with self._lock:
            if key not in self._scenes:
                self._scenes[key] = self._model.words.scene(view.picture, types)
                if len(self._scenes) > _REMEMBERED_SCENES:
                    self._scenes.popitem(last=False)
            return self._scenes[key]
