"""Looking into an answer store: what is in it, whether it is whole, and a copy to share."""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pix2pred.structs import Image, PictureError
from pix2pred.system.files import read_regular
from pix2pred.vlm.answers.store import AnswerStore, read_entry
from pix2pred.vlm.request import Answer, VLMError, key_of


@dataclass(frozen=True, slots=True)
class StoredEntry:
    """A stored question with its answer."""

    key: str
    model: str
    purpose: str
    request: dict[str, Any]
    answer: Answer

    @property
    def texts(self) -> list[str]:
        """The text parts of the question."""
        return [part for part in self.request["parts"] if isinstance(part, str)]

    @property
    def pictures(self) -> list[dict[str, Any]]:
        """The pictures of the question: how each was shown, with the digest of its pixels."""
        return [part for part in self.request["parts"] if isinstance(part, dict)]


def read_stored(store: AnswerStore, key: str) -> StoredEntry:
    """One entry. Raises ``VLMError`` for a damaged file."""
    path = store.path(key)
    try:
        document = json.loads(read_regular(path))
        request = document["request"]
        entry = StoredEntry(key, str(request["model"]), str(document["purpose"]), request, read_entry(document))
        if not all(isinstance(p, str) or _is_picture(p) for p in request["parts"]):
            raise ValueError("parts are neither text nor pictures")
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise VLMError(f"{path}: damaged answer ({error})") from error
    return entry


def _is_picture(part: Any) -> bool:
    return isinstance(part, dict) and isinstance(part.get("pixels"), str) and isinstance(part.get("heading", ""), str)


def find(store: AnswerStore, start: str) -> StoredEntry:
    """The entry whose key begins with ``start``. Raises ``VLMError`` when there is none or several."""
    found = [key for key in store.all_keys() if key.startswith(start.lower())]
    if len(found) != 1:
        what = "no answer has a key" if not found else f"{len(found)} answers have keys"
        raise VLMError(f"{store.directory}: {what} that begins with {start!r}; see 'pix2pred answers list'")
    return read_stored(store, found[0])


def problems(store: AnswerStore) -> Iterator[str]:
    """Everything that is wrong with a store: damaged files, wrong keys, missing or changed pictures."""
    checked: dict[str, str] = {}
    for key in store.all_keys():
        try:
            entry = read_stored(store, key)
        except VLMError as error:
            yield str(error)
            continue
        if key_of(entry.request) != key:
            yield f"{store.path(key)}: the question does not have this key; it was changed"
        for picture in entry.pictures:
            digest = str(picture.get("pixels", ""))
            if digest not in checked:
                checked[digest] = _wrong_with(store.blob(digest), digest)
                if checked[digest]:
                    yield checked[digest]


def read_all(store: AnswerStore) -> Iterator[StoredEntry]:
    """Every entry, one after the other, in the order of keys. Raises ``VLMError`` for a damaged file."""
    return (read_stored(store, key) for key in store.all_keys())


def _wrong_with(blob: Path, digest: str) -> str:
    if not re.fullmatch(r"[0-9a-f]{64}", digest):
        return f"{digest[:80]!r}: is not the digest of a picture"
    if not blob.is_file():
        return f"{blob}: the picture of a question is missing"
    try:
        return "" if Image(blob).digest == digest else f"{blob}: the picture was changed"
    except PictureError as error:
        return str(error)


def _picture_file(store: AnswerStore, digest: str) -> Path:
    path = store.blob(digest)
    if not re.fullmatch(r"[0-9a-f]{64}", digest) or path.is_symlink() or not path.is_file():
        raise VLMError(
            f"{store.directory}: {digest[:80]!r} names no picture of this store; nothing was exported. See "
            "'pix2pred answers verify'"
        )
    return path


def export(store: AnswerStore, target: Path, model: str | None = None) -> int:
    """Write the answers, of one model or of all, with their pictures into a zip file; gives how many answers.

    Unpacked over another store's folder it adds to it. The same answers give the same bytes. Raises ``VLMError`` for a
    picture that is no plain file of the store.
    """
    names: set[Path] = set()
    count = 0
    for key in store.all_keys():
        entry = read_stored(store, key)
        if model is None or entry.model == model:
            count += 1
            names |= {store.path(key), *(_picture_file(store, str(p.get("pixels", ""))) for p in entry.pictures)}
    partial = target.with_name(f".{target.name}.part")
    try:
        with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(names):
                info = zipfile.ZipInfo(str(path.relative_to(store.directory)), (1980, 1, 1, 0, 0, 0))
                info.external_attr = 0o644 << 16
                archive.writestr(info, path.read_bytes(), zipfile.ZIP_DEFLATED)
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)
    return count
