"""Kinds of errors to test acting with: which labels of a model are turned round, and when the error is repeated.

For studies and tests alone: nothing that users run offers them, and the model's name says what was done to it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Protocol

from pix2pred.system.seeded import draw
from pix2pred.vlm.offline.prompt_format import current_views, executed_skills
from pix2pred.vlm.request import VLM, Answer, Purpose, Request

_VALUE = re.compile(r"^([* ]*)([A-Za-z_]\w*)\(([^()]*)\): (True|False)\b", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class WantedLabel:
    """A label to be given, of ``word`` and the objects called ``names``.

    ``question`` is the key of the request, ``picture`` the digest of the first picture of the state numbered ``state``.
    """

    word: str
    names: tuple[str, ...]
    question: str
    picture: str
    state: int

    @property
    def atom(self) -> str:
        """The atom as text."""
        return f"{self.word}({', '.join(self.names)})"


class Errors(Protocol):
    """Which labels are wrong."""

    @property
    def name(self) -> str:
        """What distinguishes these errors from others, seed and rate included."""
        ...

    def notice(self, request: Request) -> None:
        """A question comes in; errors may depend on what it tells about the episode."""
        ...

    def spoilt(self, asked: WantedLabel, value: bool) -> bool | None:
        """What is said in place of ``value``; None stands for unknown."""
        ...


@dataclass(frozen=True, slots=True)
class _Stateless:
    """Errors that do not depend on what happened before in an episode.

    ``rate`` is their share of all labels, ``seed`` decides which.
    """

    rate: float
    seed: int

    @property
    def name(self) -> str:
        return f"{type(self).__name__}:{self.rate}:{self.seed}"

    def notice(self, request: Request) -> None:
        """Nothing about the episode matters."""


@dataclass(frozen=True, slots=True)
class PerQuestion(_Stateless):
    """Every answer errs for itself: asking again, in other words, may give another one."""

    def spoilt(self, asked: WantedLabel, value: bool) -> bool | None:
        wrong = draw(self.seed, asked.question, asked.atom) < self.rate
        return value != wrong


@dataclass(frozen=True, slots=True)
class PerPicture(_Stateless):
    """An atom is misread in a picture however often it is asked about there, and maybe not in the next picture."""

    def spoilt(self, asked: WantedLabel, value: bool) -> bool | None:
        wrong = draw(self.seed, asked.picture, asked.atom) < self.rate
        return value != wrong


@dataclass(frozen=True, slots=True)
class Hidden(_Stateless):
    """Unknown in place of a value, whenever an atom is asked about in one picture."""

    def spoilt(self, asked: WantedLabel, value: bool) -> bool | None:
        return None if draw(self.seed, asked.picture, asked.atom) < self.rate else value


@dataclass(frozen=True, slots=True)
class Systematic(_Stateless):
    """A word is always misread of some objects, a share ``rate`` of those whose name begins with ``kind``."""

    word: str = ""
    kind: str = ""

    @property
    def name(self) -> str:
        return f"Systematic:{self.rate}:{self.seed}:{self.word}:{self.kind}"

    def spoilt(self, asked: WantedLabel, value: bool) -> bool | None:
        concerned = asked.word == self.word and any(n.startswith(self.kind) for n in asked.names)
        return value != (concerned and draw(self.seed, asked.atom) < self.rate)


@dataclass(slots=True)
class UntilTouched:
    """An atom is misread until a skill touches one of its objects; then it is drawn anew. Of one episode alone."""

    rate: float
    seed: int
    _touched: dict[int, frozenset[str]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return f"UntilTouched:{self.rate}:{self.seed}"

    def notice(self, request: Request) -> None:
        """Remember which objects the skills before the asked states were about."""
        state = max((v.state for v in request.views), default=0)
        for i, (_, names) in enumerate(reversed(executed_skills(request.text))):
            self._touched[state - i] = frozenset(names)

    def spoilt(self, asked: WantedLabel, value: bool) -> bool | None:
        touches = sum(not names.isdisjoint(asked.names) for t, names in self._touched.items() if t <= asked.state)
        return value != (draw(self.seed, asked.atom, touches) < self.rate)


@dataclass(frozen=True, slots=True)
class ErringVLM:
    """Passes requests on, and spoils True and False labels in the answers as ``errors`` say; proposals are kept."""

    model: VLM
    errors: Errors

    @property
    def name(self) -> str:
        return f"{self.model.name}+{self.errors.name}"

    def answer(self, request: Request) -> Answer:
        answer = self.model.answer(request)
        views = current_views(request.views)
        if request.purpose == Purpose.PROPOSE or not views:
            return answer
        self.errors.notice(request)
        question, picture, state = request.key(self.model.name), views[0].picture.image.digest, views[0].state
        words = {True: "True", False: "False", None: "Unknown"}

        def value(match: re.Match[str]) -> str:
            names = tuple(n.strip() for n in match[3].split(","))
            asked = WantedLabel(match[2], names, question, picture, state)
            said = self.errors.spoilt(asked, match[4] == "True")
            return f"{match[1]}{match[2]}({match[3]}): {words[said]}"

        return Answer(_VALUE.sub(value, answer.text), answer.stored)
