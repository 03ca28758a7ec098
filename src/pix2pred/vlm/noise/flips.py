"""A model whose labels are sometimes turned round, for studies of noise: never part of a comparison."""

from __future__ import annotations

import hashlib
import re

from pix2pred.vlm.offline.prompt_format import current_views
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
        if request.purpose == Purpose.PROPOSE or not views:
            return answer
        picture = views[0].picture.image.digest

        def value(match: re.Match[str]) -> str:
            text = f"{self._seed}|{picture}|{match[2]}"
            draw = int.from_bytes(hashlib.sha256(text.encode()).digest()[:7]) / 2**56
            said = (match[3] == "True") != (draw < self._rate)
            return f"{match[1]}{match[2]}: {said}"

        return Answer(_VALUE.sub(value, answer.text), answer.stored)
