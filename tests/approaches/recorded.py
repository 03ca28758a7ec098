"""Answers written by hand, played back through the answer store: no model is asked when they are used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pix2pred.vlm import Answer, AnswerStore, Request, StoredVLM, StoreMode, VLMError

FOLDER = Path(__file__).parents[1] / "data" / "recorded"
NAME = "recorded-by-hand"


def text(name: str) -> str:
    return (FOLDER / f"{name}.txt").read_text(encoding="utf-8")


@dataclass
class Author:
    """Writes the answers into a store."""

    answers: Callable[[Request], str]
    name: str = NAME

    def answer(self, request: Request) -> Answer:
        return Answer(self.answers(request))


@dataclass
class Nobody:
    """A model that must not be asked."""

    name: str = NAME

    def answer(self, request: Request) -> Answer:
        raise VLMError("nobody is there to answer")


def recording(folder: Path, answers: Callable[[Request], str]) -> StoredVLM:
    return StoredVLM(Author(answers), AnswerStore(folder))


def replay(folder: Path) -> StoredVLM:
    return StoredVLM(Nobody(), AnswerStore(folder), StoreMode.REPLAY)
