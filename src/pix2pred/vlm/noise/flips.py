"""A model whose labels are sometimes turned round, for studies of noise: never part of a comparison."""

from __future__ import annotations

import re

from pix2pred.system.seeded import draw
from pix2pred.vlm.offline.prompt_format import current_views, histories, history_line, states_shown
from pix2pred.vlm.request import VLM, Answer, Purpose, Request

_VALUE = re.compile(r"^([* ]*)([A-Za-z_]\w*\([^()]*\)): (True|False)\b", re.MULTILINE)


class FlippingVLM:
    """Passes requests on and flips a share ``rate`` of the True and False labels in the answers.

    Seed, picture and atom alone decide which: asking again, or double checking, changes nothing.
    """

    def __init__(self, model: VLM, rate: float, seed: int) -> None:
        self.name = f"{model.name}+flipped:{rate}:{seed}"
        self._model = model
        self._rate = rate
        self._seed = seed

    def answer(self, request: Request) -> Answer:
        """The model's answer with some labels flipped; proposals are left alone."""
        answer = self._model.answer(request)
        views = current_views(request.views)
        if request.purpose in (Purpose.PROPOSE, Purpose.DEFINE) or not views:
            return answer
        if request.purpose == Purpose.HISTORY:
            pictures = {number: shown[0].picture.image.digest for number, shown in states_shown(request.views).items()}
            lines = [
                history_line(atom, {n: self._said(pictures[n], atom, value) for n, value in values.items()})
                for atom, values in histories(answer.text, list(pictures))
            ]
            return Answer("\n".join(lines), answer.stored)
        picture = views[0].picture.image.digest

        def value(match: re.Match[str]) -> str:
            return f"{match[1]}{match[2]}: {self._said(picture, match[2], match[3] == 'True')}"

        return Answer(_VALUE.sub(value, answer.text), answer.stored)

    def _said(self, picture: str, atom: str, value: bool | None) -> bool | None:
        """The value that is given in place of ``value``; what is unknown stays so."""
        return None if value is None else value != (draw(self._seed, picture, atom) < self._rate)
