"""What the model was asked about the demonstrations and what it said, to be read in full."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pix2pred.report.contents import Contents
from pix2pred.vlm import AnswerStore, Purpose, VLMError
from pix2pred.vlm.answers.inspection import StoredEntry, read_stored

MOST = 40
"""Questions shown: a few of each kind; the rest are read with ``pix2pred answers show``."""

LONGEST = 20_000
"""Characters shown of a prompt or an answer."""


@dataclass(frozen=True, slots=True)
class ShownQuestion:
    """A question as the page shows it: the ``prompt`` without its pictures, and the ``answer``.

    ``key`` is that of the answer store, ``purpose`` the step that asked, ``about`` the demonstration and state.
    """

    key: str
    purpose: str
    about: str
    prompt: str
    answer: str


@dataclass(frozen=True, slots=True)
class Questions:
    """The questions shown, how many there are in all, and the folder that holds them."""

    shown: tuple[ShownQuestion, ...]
    total: int
    folder: str


def questions(contents: Contents) -> Questions:
    """Questions of the run's model about its own pictures, in the order of demonstrations and states.

    Stores shared with other runs hold others, which are left out; damaged answers are, too.
    """
    places = {
        picture.digest: (d, t, f"{demo.name}, state {t}")
        for d, demo in enumerate(contents.evidence.demos)
        for t, pictures in enumerate(demo.states)
        for picture in pictures
    }
    for blobs in contents.blobs:
        found = _of_store(blobs.parent, contents.model.labels_from, places)
        if found:
            ordered = [question for _, question in sorted(found, key=lambda item: item[0])]
            step = max(1, -(-len(ordered) // MOST))
            return Questions(tuple(ordered[::step]), len(ordered), str(blobs.parent))
    return Questions((), 0, "")


Place = tuple[int, int, str]
"""Number of the demonstration, of the state, and both in words."""


def _of_store(folder: Path, model: str, places: dict[str, Place]) -> list[tuple[tuple[int, int, str], ShownQuestion]]:
    store = AnswerStore(folder)
    found = []
    for key in store.all_keys():
        try:
            entry = read_stored(store, key)
        except VLMError:
            continue
        seen = [places[d] for p in entry.pictures if (d := _digest(p)) in places]
        if entry.model == model and seen:
            demo, state, about = max(seen) if entry.purpose != Purpose.PROPOSE else min(seen)
            found.append(((demo, state, key), _question(entry, about)))
    return found


def _digest(picture: dict[str, object]) -> str:
    return str(picture.get("pixels", ""))


def _question(entry: StoredEntry, about: str) -> ShownQuestion:
    return ShownQuestion(entry.key, entry.purpose, about, _cut("\n".join(entry.texts)), _cut(entry.answer.text))


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}\n... ({len(text) - LONGEST:,} characters more)"
