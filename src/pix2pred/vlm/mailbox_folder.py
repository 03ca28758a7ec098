"""The folder of a mailbox, as whoever answers sees it: what waits, what each question asks, and how to answer it.

It knows files alone, so that a page or a person can answer while the program that asks runs elsewhere, or not at all.
"""

from __future__ import annotations

import json
import re
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from pix2pred.system.errors import Pix2predError
from pix2pred.system.files import write_whole
from pix2pred.vlm.offline.prompt_format import asked_atoms, history_line, previous_values, stated_values
from pix2pred.vlm.request import Purpose

ANSWERED = "answered"
ANSWER = "answer.txt"
PROGRESS = "progress.json"
MOST_BYTES = 1 << 20
"""Longer answers are no answers."""
_RECENT = 20
"""Answers from whose times the speed of whoever answers is taken."""
_PAUSE = 300.0
"""Seconds between two answers that count at most: longer is a break."""
_SKILL = re.compile(r"^Executed skill: (.*)$", re.MULTILINE)
_MEANING = re.compile(r"^- ([A-Za-z_]\w*)\(.*?\): (.*)$", re.MULTILINE)
_FREE = (Purpose.PROPOSE, Purpose.DEFINE, Purpose.PLAN, Purpose.CODE, Purpose.DOCTOR)
"""Questions that are answered in words, not by values of atoms."""
_WORDS: Mapping[str, bool | None] = {"True": True, "False": False, "Unknown": None}


class MailboxError(Pix2predError, ValueError):
    """A question that does not wait, or an answer that says nothing."""


@dataclass(frozen=True, slots=True)
class ShownPicture:
    """A picture of a question: its file, its heading, the number of its state, whether it shows a part alone."""

    file: str
    heading: str
    state: int
    is_part: bool


@dataclass(frozen=True, slots=True)
class AtomToLabel:
    """An atom with the value it had before and the one that an earlier answer gave, as words, and its meaning."""

    atom: str
    before: str
    said: str
    meaning: str


@dataclass(frozen=True, slots=True)
class MailboxQuestion:
    """One question. ``states`` are those to give values in; none when the answer is free text."""

    name: str
    about: str
    purpose: str
    skill: str
    pictures: tuple[ShownPicture, ...]
    atoms: tuple[AtomToLabel, ...]
    states: tuple[int, ...]
    prompt: str
    problem: str
    returned: str


@dataclass(frozen=True, slots=True)
class MailboxStatus:
    """Questions that wait, names in order; how many are answered, lie ready to be taken, and will come in all.

    ``expected`` is ``None`` where no dry run could be made, ``seconds`` of what is left where nothing tells.
    """

    waiting: tuple[str, ...]
    ready: int
    answered: int
    expected: int | None
    seconds: float | None


class MailboxFolder:
    """The mailbox in ``path``."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def standing(self) -> MailboxStatus:
        """What waits and how far it is."""
        folders = [p.parent for p in self.path.glob("*/request.json")]
        waiting = sorted((f.name for f in folders if not _is_file(f / ANSWER)), key=_natural)
        times = sorted(_time(p) for p in (self.path / ANSWERED).glob("*/request.json"))
        expected = self._expected()
        left = None if expected is None else max(0, expected - len(times))
        return MailboxStatus(tuple(waiting), len(folders) - len(waiting), len(times), expected, _seconds(times, left))

    def question(self, name: str) -> MailboxQuestion:
        """The question ``name``. Raises ``MailboxError`` unless it waits and can be read."""
        folder = self._folder(name)
        try:
            document = json.loads((folder / "request.json").read_text(encoding="utf-8"))
            parts, about, purpose = document["request"]["parts"], str(document["about"]), str(document["purpose"])
            pictures = tuple(_pictures(parts))
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise MailboxError(
                f"{folder / 'request.json'}: is damaged; remove the folder, and the same command asks anew"
            ) from error
        text = "\n\n".join(part for part in parts if isinstance(part, str))
        returned = self._latest_returned(folder)
        labels = purpose not in _FREE
        states = _states(pictures, purpose) if labels else ()
        skill = _SKILL.search(text)
        return MailboxQuestion(
            name, about, purpose, skill[1] if skill else "", pictures,
            tuple(_atoms(text, returned)) if labels else (), states, text, _read(folder / "problem.md"), returned,
        )  # fmt: skip

    def picture(self, name: str, file: str) -> bytes:
        """A picture of a question that waits. Raises ``MailboxError`` for anything else."""
        path = self._folder(name) / file
        if not re.fullmatch(r"\d+\.png", file) or not _is_file(path):
            raise MailboxError(f"{file}: is no picture of this question")
        return path.read_bytes()

    def answer(self, name: str, body: Mapping[str, Any]) -> None:
        """Answer a question with ``body["values"]``, words by atom and state, or with ``body["text"]``.

        Raises ``MailboxError`` when something is missing.
        """
        question = self.question(name)
        text = body.get("text")
        if question.atoms:
            values = body.get("values")
            text = _answer(question, values if isinstance(values, Mapping) else {})
        if not isinstance(text, str) or not text.strip() or len(text) > MOST_BYTES:
            raise MailboxError("the answer is empty, or too long")
        write_whole(self._folder(name) / ANSWER, text.encode("utf-8", errors="replace"))

    def _folder(self, name: str) -> Path:
        if name not in self.standing().waiting:
            raise MailboxError("this question does not wait any more")
        return self.path / name

    def _expected(self) -> int | None:
        try:
            count = json.loads(_read(self.path / PROGRESS) or "{}").get("expected")
        except (ValueError, AttributeError):
            return None
        return count if isinstance(count, int) and not isinstance(count, bool) else None

    def _latest_returned(self, folder: Path) -> str:
        found = sorted((p.name for p in folder.glob("answer-returned-*.txt")), key=_natural)
        return _read(folder / found[-1]) if found else ""


def form(text: str) -> str:
    """Lines to fill in: the atoms that ``text`` asks about, with the value that is known so far, or ``?``."""
    return "".join(f"* {a.atom}: {a.said or a.before or '?'}\n" for a in _atoms(text, ""))


def _atoms(text: str, returned: str) -> list[AtomToLabel]:
    before, said = previous_values(text), stated_values(text) | stated_values(f"<answer>\n{returned}\n</answer>")
    meanings = dict(_MEANING.findall(text))
    return [
        AtomToLabel(str(a), before.get(str(a), ""), said.get(str(a), ""), meanings.get(a.word, ""))
        for a in asked_atoms(text)
    ]


def _pictures(parts: list[Any]) -> list[ShownPicture]:
    views = [part for part in parts if not isinstance(part, str)]
    return [
        ShownPicture(f"{n:02}.png", str(v["heading"]), int(v["state"]), v["crop"] is not None)
        for n, v in enumerate(views, start=1)
    ]


def _states(pictures: Sequence[ShownPicture], purpose: str) -> tuple[int, ...]:
    """The states whose values are asked for: all that are shown, or the last."""
    shown = sorted({p.state for p in pictures if not p.is_part}) or [0]
    return tuple(shown if purpose == Purpose.HISTORY else shown[-1:])


def _answer(question: MailboxQuestion, values: Mapping[str, Any]) -> str:
    """The lines of an answer. Raises ``MailboxError`` naming an atom without a value."""
    lines = []
    for row in question.atoms:
        given = values.get(row.atom)
        words = [str(given.get(str(state))) if isinstance(given, Mapping) else "" for state in question.states]
        if any(word not in _WORDS for word in words):
            raise MailboxError(f"{row.atom}: choose True, False or Unknown")
        by_state = {state: _WORDS[word] for state, word in zip(question.states, words, strict=True)}
        if question.purpose == Purpose.HISTORY:
            lines.append(history_line(row.atom, by_state))
        else:
            lines.append(f"* {row.atom}: {words[0]}")
    return "\n".join(lines) + "\n"


def _seconds(times: list[float], left: int | None) -> float | None:
    """Seconds that ``left`` more answers will take at the speed of the recent ones."""
    gaps = [min(_PAUSE, b - a) for a, b in pairwise(times[-_RECENT:])]
    return statistics.median(gaps) * left if gaps and left is not None else None


def _natural(name: str) -> list[tuple[int, str]]:
    """A key by which state 2 comes before state 10."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)]


def _is_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()


def _time(path: Path) -> float:
    answer = path.with_name(ANSWER)
    return (answer if answer.exists() else path).stat().st_mtime


def _read(path: Path) -> str:
    """The text of a small regular file; empty for anything else."""
    if not _is_file(path) or path.stat().st_size > MOST_BYTES:
        return ""
    return path.read_bytes().decode("utf-8", errors="replace").removeprefix("\ufeff").strip()
