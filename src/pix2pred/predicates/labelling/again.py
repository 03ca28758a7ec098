"""Asking about one atom again: alone, with a crop of its objects, in other words (method 8.8).

An error of a model that depends on how it is asked is not repeated; one that lies in the picture is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pix2pred.images import skill_crop
from pix2pred.predicates.labelling.asking import TOKENS_OF_REASONING, TOKENS_PER_ATOM
from pix2pred.predicates.labelling.label_format import LabelFormat
from pix2pred.predicates.labelling.state_labels import StateLabeller
from pix2pred.predicates.prompt import atom_text, fill, meaning_lines, object_lines, views
from pix2pred.structs import Atom, Label, Object, State
from pix2pred.structs.views import View
from pix2pred.vlm import NoAnswerError, Request
from pix2pred.vlm.answers.stored import ReplayMissError
from pix2pred.vlm.request import Purpose

WORDINGS = ("label_again", "label_against")
"""Prompts of the questions, in the order in which they are asked."""


@dataclass(frozen=True, slots=True)
class SecondLook:
    """Asks the labeller's model about single atoms of a state that was labelled before."""

    labeller: StateLabeller

    def ask(self, state: State, t: int, objects: Sequence[Object], atom: Atom, number: int) -> Label:
        """The answer to the question with this ``number`` (from 0) about ``atom`` in the state with number ``t``.

        Questions of different numbers differ in wording, in the camera that comes first, and, when the wordings are
        used up, in the sample. Unknown when there is no usable answer.
        """
        settings = self.labeller.settings
        form = LabelFormat(settings.structured)
        text = atom_text(atom)
        meaning = f"\nMeaning:\n{meaning_lines([atom.predicate])}\n" if atom.predicate.description else ""
        wording = WORDINGS[number % len(WORDINGS)]
        question = fill(wording, objects=object_lines(objects), meaning=meaning, atoms=text)
        request = Request(
            Purpose.ASK_AGAIN,
            (question, *self._pictures(state, t, objects, atom, number)),
            TOKENS_OF_REASONING + TOKENS_PER_ATOM,
            temperature=settings.sampling_temperature,
            sample=number // len(WORDINGS),
            schema=form.schema([text]),
            about=f"episode, state {t}: {text} again",
        )
        try:
            answer = self.labeller.vlm.answer(request)
        except (NoAnswerError, ReplayMissError):  # recordings of before hold no such questions
            return Label.UNKNOWN
        return form.read(answer.text, [text]).values.get(text, Label.UNKNOWN)

    def _pictures(self, state: State, t: int, objects: Sequence[Object], atom: Atom, number: int) -> list[View]:
        """The state's pictures, and of each the part with the atom's objects; the cameras turn with ``number``."""
        settings = self.labeller.settings
        whole = views(state, t, objects, marks=settings.marks, longest_side=settings.longest_side)
        first = number % len(whole) if whole else 0
        names = [o.name for o in atom.objects]
        cropped = []
        for camera, (picture, view) in enumerate(zip(state.pictures, whole, strict=True)):
            crop = skill_crop(state, state, names, camera, picture.image.size)
            if crop is not None:
                cropped.append(replace(view, crop=crop, heading=f"{view.heading}, close"))
        return [*whole[first:], *whole[:first], *cropped[first:], *cropped[:first]]
