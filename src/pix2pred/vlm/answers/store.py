"""The answer store: every answer as a plain JSON file under its key, so that none is ever paid for twice.

``answers/ab/<sha256>.json`` holds question and answer, ``blobs/<sha256>.png`` each picture once, clean. Folders merge
by copying. Files are written under another name and renamed, so a file that exists is complete. No key, header,
address or path of the machine is written.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pix2pred.structs import Image
from pix2pred.system.files import check_writable, read_regular, remove_abandoned, write_whole
from pix2pred.vlm.request import Answer, Finish, Request, Spent, Token, VLMError

VERSION = 1
_MOST_TOKENS = 1 << 40
_LARGEST = 1e12
"""Of dollars and logarithms: what is larger was not written by us."""
_SURROGATE = re.compile("[\ud800-\udfff]")
_NAME = re.compile(r"[0-9a-f]{64}")
"""Answers and pictures are named by a SHA-256; other files in a store's folders are none of ours."""


class AnswerStore:
    """A folder of answers."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory

    def check(self) -> None:
        """Raise ``VLMError`` when the folder cannot be one, before anything is paid for."""
        for folder in (self.directory, self.directory / "answers", self.directory / "blobs"):
            if folder.exists() and not folder.is_dir():
                raise VLMError(f"{folder}: is a file, not a folder of answers")

    def check_writable(self) -> None:
        """Rid the folder of what killed processes left. Raises ``VLMError`` when nothing can be written into it."""
        try:
            check_writable(self.directory / "answers")
            remove_abandoned(self.directory)
        except OSError as error:
            raise VLMError(
                f"{self.directory}: answers cannot be stored here ({error.strerror}); nothing was asked, because an "
                "answer that cannot be stored is lost. Name another folder with --answers"
            ) from error

    def get(self, key: str) -> Answer | None:
        """The stored answer. Raises ``VLMError`` for a damaged file."""
        path = self.path(key)
        try:
            return read_entry(json.loads(read_regular(path)))
        except FileNotFoundError:
            return None
        except OSError as error:
            raise VLMError(f"{path}: cannot be read ({error.strerror})") from error
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise VLMError(f"{path}: damaged answer ({error}); delete the file to ask again") from error

    def put(self, request: Request, model: str, answer: Answer) -> None:
        """Store an answer and the pictures of its question. Raises ``VLMError`` when that fails."""
        try:
            for view in request.views:
                self.keep_picture(view.picture.image)
            entry = write_entry(request, model, answer)
            write_whole(self.path(request.key(model)), json.dumps(entry, indent=1).encode())
        except OSError as error:
            raise VLMError(
                f"{error.filename or self.directory}: an answer could not be stored ({error.strerror}); answers stored "
                "before are safe. Make room or name another folder with --answers, then run the same command again"
            ) from error

    def all_keys(self) -> list[str]:
        """The keys of all answers, sorted."""
        return sorted(self._found())

    def _found(self) -> Iterator[str]:
        answers = self.directory / "answers"
        for folder in os.scandir(answers) if answers.is_dir() else ():
            if len(folder.name) == 2 and folder.is_dir(follow_symlinks=False):
                for entry in os.scandir(folder.path):
                    name, _, ending = entry.name.partition(".")
                    if ending == "json" and _NAME.fullmatch(name) and entry.is_file(follow_symlinks=False):
                        yield name

    def blob(self, digest: str) -> Path:
        """Where the picture with this digest of its pixels lies."""
        return self.directory / "blobs" / f"{digest}.png"

    def keep_picture(self, image: Image) -> None:
        """Write a picture, clean of all but its pixels, unless it is there."""
        path = self.blob(image.digest)
        if path.exists():
            return
        encoded = image.encoded
        if not _is_bare_png(encoded):
            encoded = image.alone(lambda: Image.from_pixels(image.pixels()).encoded)
        write_whole(path, encoded)

    def path(self, key: str) -> Path:
        """Where the answer with this key lies."""
        return self.directory / "answers" / key[:2] / f"{key}.json"


def _is_bare_png(encoded: bytes) -> bool:
    """Whether a file is a PNG of 8-bit RGB that holds the picture alone: no text, date or place."""
    if not encoded.startswith(b"\x89PNG\r\n\x1a\n") or encoded[24:29] != b"\x08\x02\x00\x00\x00":
        return False
    place, kinds = 8, []
    while place + 12 <= len(encoded):
        kinds.append(encoded[place + 4 : place + 8])
        place += 12 + int.from_bytes(encoded[place : place + 4])
    return place == len(encoded) and set(kinds) == {b"IHDR", b"IDAT", b"IEND"} and kinds[-1] == b"IEND"


def write_entry(request: Request, model: str, answer: Answer) -> dict[str, Any]:
    """The JSON document of an answer. What an offline model leaves empty is left out."""
    entry: dict[str, Any] = {
        "version": VERSION,
        "purpose": request.purpose,
        "request": request.canonical(model),
        "answer": answer.text,
    }
    if answer.finish != Finish.COMPLETE:
        entry["finish"] = answer.finish.value
    spent = answer.spent
    if spent.input_tokens or spent.output_tokens:
        entry["tokens"] = [spent.input_tokens, spent.output_tokens]
    if spent.cached_tokens:
        entry["cached"] = spent.cached_tokens
    if spent.dollars is not None:
        entry["dollars"] = spent.dollars
    if answer.tokens:
        entry["logprobs"] = [[t.text, *([text, round(p, 5)] for text, p in t.logprobs)] for t in answer.tokens]
    return entry


def read_entry(entry: Any) -> Answer:
    """The answer in a JSON document. Raises ``ValueError``, ``TypeError``, ``KeyError`` or ``AttributeError``."""
    if entry["version"] != VERSION or not isinstance(entry["answer"], str):
        raise ValueError(f"is not a stored answer of version {VERSION}")
    given, taken = entry.get("tokens", (0, 0))
    dollars = entry.get("dollars")
    return Answer(
        _SURROGATE.sub("\N{REPLACEMENT CHARACTER}", entry["answer"]),
        stored=True,
        finish=Finish(entry.get("finish", Finish.COMPLETE)),
        tokens=tuple(_read_token(token) for token in entry.get("logprobs", ())),
        spent=Spent(
            _count(given),
            _count(taken),
            None if dollars is None else _amount(dollars),
            cached_tokens=_count(entry.get("cached", 0)),
        ),
    )


def _read_token(token: Any) -> Token:
    text, *alternatives = token
    return Token(str(text), tuple((str(t), min(0.0, _amount(p))) for t, p in alternatives))


def _count(number: Any) -> int:
    """A count of tokens. Raises ``ValueError`` for what no answer can have taken."""
    if not isinstance(number, int) or not 0 <= number <= _MOST_TOKENS:
        raise ValueError("a count of tokens that cannot be")
    return number


def _amount(number: Any) -> float:
    """A finite number. Raises ``ValueError`` for any other."""
    if isinstance(number, bool) or not isinstance(number, int | float) or not abs(number) < _LARGEST:
        raise ValueError("a number that cannot be")
    return float(number)
