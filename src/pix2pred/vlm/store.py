"""The answer store: every answer as a plain JSON file under its key, so that none is ever paid for twice.

``answers/ab/<sha256>.json`` holds question and answer, ``blobs/<sha256>.png`` each picture once, clean. Folders merge
by copying. Files are written under another name and renamed, so a file that exists is complete.
"""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path

from pix2pred.structs import Image
from pix2pred.structs.files import write_whole
from pix2pred.structs.views import View
from pix2pred.vlm.request import VLM, Answer, Request, VLMError

VERSION = 1


class StoreMode(StrEnum):
    """LIVE always asks; RESUME asks what is not stored; REPLAY never asks, a miss is an error."""

    LIVE = "live"
    RESUME = "resume"
    REPLAY = "replay"


class ReplayMissError(VLMError):
    """A question that the store has no answer to, in replay mode."""


class AnswerStore:
    """A folder of answers."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory

    def check(self) -> None:
        """Raise ``VLMError`` when the folder cannot be one."""
        if self.directory.exists() and not self.directory.is_dir():
            raise VLMError(f"{self.directory}: is a file, not a folder of answers")

    def get(self, key: str) -> str | None:
        """The stored answer text. Raises ``VLMError`` for a damaged file."""
        path = self._path(key)
        try:
            entry = json.loads(path.read_text(encoding="utf-8"))
            if entry["version"] != VERSION or not isinstance(entry["answer"], str):
                raise VLMError(f"{path}: is not a stored answer of version {VERSION}")
            return str(entry["answer"])
        except FileNotFoundError:
            return None
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise VLMError(f"{path}: damaged answer ({error}); delete the file to ask again") from error

    def put(self, request: Request, model: str, answer: str) -> None:
        """Store an answer and the pictures of its question."""
        for view in request.views:
            self._put_picture(view)
        entry = {
            "version": VERSION,
            "purpose": request.purpose,
            "request": request.canonical(model),
            "answer": answer,
        }
        write_whole(self._path(request.key(model)), json.dumps(entry, indent=1).encode())

    def _put_picture(self, view: View) -> None:
        path = self.directory / "blobs" / f"{view.picture.image.digest}.png"
        if not path.exists():
            write_whole(path, Image.from_pixels(view.picture.image.pixels()).encoded)  # no metadata, always PNG

    def _path(self, key: str) -> Path:
        return self.directory / "answers" / key[:2] / f"{key}.json"


class StoredVLM:
    """A model behind an answer store."""

    def __init__(self, model: VLM, store: AnswerStore, mode: StoreMode = StoreMode.RESUME) -> None:
        self.name = model.name
        self._model = model
        self._store = store
        self._mode = mode

    def answer(self, request: Request) -> Answer:
        """The stored answer if the mode allows, else the model's, stored before it is returned."""
        key = request.key(self.name)
        if self._mode != StoreMode.LIVE and (text := self._store.get(key)) is not None:
            return Answer(text, stored=True)
        if self._mode == StoreMode.REPLAY:
            raise ReplayMissError(
                f"the store {self._store.directory} has no answer to a {request.purpose} query of {self.name} "
                f"(key {key[:12]}); run once with --mode resume to ask the model"
            )
        answer = self._model.answer(request)
        self._store.put(request, self.name, answer.text)
        return answer
