"""What a provider of hosted models is: everything that differs between providers are members of one class.

A new provider is one file with a subclass, and one line in the registry (or an entry point of another package).
"""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar

from pix2pred.system.extras import install_command
from pix2pred.vlm.request import Request, VLMError

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model


class Parameter(StrEnum):
    """What is sent beside the question, and may be left out when a server does not take it."""

    TEMPERATURE = "temperature"
    SEED = "seed"
    LOGPROBS = "logprobs"
    SCHEMA = "response_format"
    THINKING = "thinking"
    BUDGET_NAME = "max_tokens"
    """Left out means: the budget goes by the provider's other name for it."""


LIKELY_TOKENS = 5
"""Tokens whose probabilities are asked for at every place: the three words of a label and two spellings more."""


class Provider(ABC):
    """One provider: its key, its client, how its parameters are called, what it counts and what it cannot do."""

    name: ClassVar[str]
    """How it is called before the colon of ``--vlm``, in the names of extras and in price lists."""
    form: ClassVar[str]
    """How its models are written, for messages."""
    key_variables: ClassVar[tuple[str, ...]]
    """Environment variables that hold its key, the first that is set; keys come from nowhere else."""
    has_address: ClassVar[bool] = False
    """Whether a model is named with the address of a server, which may do without a key."""

    @abstractmethod
    def client(self, model: str, url: str, key: str, http: httpx2.AsyncClient, left_out: frozenset[Parameter]) -> Model:
        """A client of ``model``. Raises ``ImportError`` when the provider's package is not installed."""

    @abstractmethod
    def picture_tokens(self, width: int, height: int) -> int:
        """Input tokens of a picture of ``width`` x ``height`` pixels, by the provider's published rule."""

    def thinking_tokens(self, model: str) -> int:
        """Tokens that ``model`` may think before it speaks unless told otherwise; 0 for a model that does not."""
        return 0

    def cached_tokens(self, repeated: int) -> int:
        """How many of the first ``repeated`` input tokens, sent before, it reads from its prompt cache unasked."""
        return 0

    def settings(self, request: Request, thinking: int | None, left_out: frozenset[Parameter]) -> dict[str, Any]:
        """What is sent beside text, pictures, budget and temperature, by the client library's names.

        ``thinking`` is the budget for thinking that a person set: 0 is none at all, ``None`` the model's own.
        """
        made: dict[str, Any] = {"max_retries": 0}
        if Parameter.SEED not in left_out:
            made["seed"] = 1000 * request.sample + request.attempt
        return made

    def takes_temperature(self, model: str, thinking: int | None) -> bool:
        """Whether a temperature may be sent to ``model`` beside a budget for thinking."""
        return True

    def key(self) -> str | None:
        """The provider's key, from the environment, without the line end that files of keys leave behind."""
        found = (os.environ.get(name, "").strip() for name in self.key_variables)
        return next((key for key in found if key), None)

    @property
    def keys_in_words(self) -> str:
        """The environment variables, for messages."""
        return " or ".join(self.key_variables)


@dataclass(frozen=True, slots=True)
class HostedModel:
    """A model behind HTTP. ``url`` is empty for the providers that have one address."""

    provider: Provider
    model: str
    url: str = ""

    @property
    def name(self) -> str:
        """What stands in stored answers: no address, so that a store replays wherever the model is served from."""
        return f"{self.provider.name}:{self.model}"

    @property
    def place(self) -> str:
        """Where it is reached, for messages."""
        return self.url or self.provider.name

    def connect(self, key: str, http: httpx2.AsyncClient, left_out: frozenset[Parameter]) -> Model:
        """A client of the model. Raises ``VLMError`` naming the extra to install when a package is missing."""
        try:
            return self.provider.client(self.model, self.url, key, http, left_out)
        except ImportError as error:
            raise VLMError(f"{self.name}: needs {install_command(self.provider.name)} ({error.name})") from error
