"""What ``--vlm`` names, read once: a kind of model before the colon, and what the kind makes of the rest.

A kind is one file with a subclass of ``ModelSpec``, and one line in the registry.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from pix2pred.structs.views import View
from pix2pred.system.errors import Pix2predError
from pix2pred.vlm.control.flow import FlowSettings
from pix2pred.vlm.control.guard import Estimate
from pix2pred.vlm.request import VLM

Draw = Callable[[View], bytes]
"""The PNG file of a view."""
_LONGEST_SHOWN = 200
"""Characters of a name that nobody knows, in a message about it."""


class ModelNameError(Pix2predError, ValueError):
    """A name that says no model; the message says which forms there are."""


@dataclass(frozen=True, slots=True)
class Spending:
    """What a run may spend on a hosted model: requests, and US dollars.

    ``estimate`` is a dry run, beyond a multiple of which the run stops. Raises ``ModelNameError`` for no amount.
    """

    max_requests: int | None = None
    max_cost: float | None = None
    estimate: Estimate | None = None

    def __post_init__(self) -> None:
        if self.max_cost is not None and not 0 <= self.max_cost < float("inf"):
            raise ModelNameError(f"--max-cost {self.max_cost}: is no number of dollars that could be reached")


@dataclass(frozen=True, slots=True)
class Setup:
    """What a model is made with: how pictures are drawn, how to ask, what may be spent, and the run's domain.

    ``reader`` is the folder of the offline reader of ``domain``, where it has one.
    """

    draw: Draw
    flow: FlowSettings = field(default_factory=FlowSettings)
    spending: Spending = field(default_factory=Spending)
    domain: str = ""
    reader: Path | None = None


class Rates(Protocol):
    """What questions to a model count and cost, for estimates."""

    def picture_tokens(self, width: int, height: int) -> int:
        """Input tokens of a picture of ``width`` x ``height`` pixels."""
        ...

    def thinking_tokens(self) -> int:
        """Tokens the model may think about one question before it speaks."""
        ...

    def cached_tokens(self, repeated: int) -> int:
        """How many of the first ``repeated`` input tokens, sent before in the same order, are read from a cache."""
        ...

    def dollars(self, input_tokens: int, output_tokens: int) -> float | None:
        """US dollars; ``None`` where the price is not known."""
        ...


class ModelSpec(ABC):
    """A model that can be named: how to reach it, and what is known of it without asking it."""

    @abstractmethod
    def connect(self, setup: Setup) -> VLM:
        """The model, ready to be asked. Raises ``VLMError`` or ``ModelNameError`` when it cannot be reached."""

    def by_name(self, setup: Setup) -> VLM:
        """The model for a replay of its answers, which needs neither key nor network."""
        return self.connect(setup)

    def around(self, setup: Setup, asked: Callable[[ModelSpec], VLM]) -> VLM:
        """The model, with whatever of it costs questions made by ``asked``, which may put a store before it."""
        return asked(self)

    def known(self) -> str:
        """What can be said of the model without asking it; empty for one that has to be asked."""
        return ""

    @property
    def writes(self) -> bool:
        """Whether the model writes plans and code as well as labels."""
        return True

    @property
    def asks_the_rest(self) -> bool:
        """Whether what the model does not know is asked of the one named after it."""
        return False

    @property
    def own_answers(self) -> Path | None:
        """The store that takes the model's place, for a model that is nothing else."""
        return None

    @property
    def waits_in(self) -> Path | None:
        """The folder in which questions wait for a person, for a model that is one."""
        return None

    @property
    def rates(self) -> Rates | None:
        """What its questions cost; ``None`` for what costs nothing."""
        return None


@dataclass(frozen=True, slots=True)
class MadeSpec(ModelSpec):
    """A model that a function of other code makes of the text after the colon."""

    make: Callable[[str], VLM]
    rest: str

    @classmethod
    def by(cls, make: Callable[[str], VLM]) -> Callable[[str], ModelSpec]:
        """What reads the names of such models."""
        return lambda rest: cls(make, rest)

    def connect(self, setup: Setup) -> VLM:
        return self.make(self.rest)


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of model: how it is written, and what makes a ``ModelSpec`` of the text after the colon."""

    form: str
    read: Callable[[str], ModelSpec]


def read_model(text: str, kinds: Mapping[str, Kind]) -> ModelSpec:
    """The model that ``text`` names. Raises ``ModelNameError`` with the forms of ``kinds``."""
    if not text.isprintable():
        raise ModelNameError(f"--vlm {_shown(text)}: holds a character that cannot be printed")
    name, _, rest = text.partition(":")
    kind = kinds.get(name)
    if kind is None or bool(rest) != (":" in kind.form):
        forms = ", ".join(k.form for k in kinds.values())
        raise ModelNameError(f"--vlm {_shown(text)}: is not one of {forms}")
    return kind.read(rest)


def _shown(text: str) -> str:
    """The name for an error message, without what could be a password, as plain characters."""
    head, at, tail = text.rpartition("@")
    shown = f"{head.partition('://')[0]}@{tail}" if at and "://" in head else text
    return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in shown[:_LONGEST_SHOWN])
