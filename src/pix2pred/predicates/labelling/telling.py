"""A model that is told with every question what belongs to it without being part of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pix2pred.structs.views import View
from pix2pred.vlm import VLM, Answer, Request


@dataclass(frozen=True, slots=True)
class Telling:
    """Passes questions on with the demonstration they are about and the pictures of the question to follow."""

    model: VLM
    demo: str
    upcoming: tuple[View, ...] = ()

    @property
    def name(self) -> str:
        return self.model.name

    def answer(self, request: Request) -> Answer:
        return self.model.answer(replace(request, demo=self.demo, upcoming=self.upcoming))
