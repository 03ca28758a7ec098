"""Hosted models and one's own servers, through ``pydantic_ai.direct``: one request, one answer, no repetition.

Threads ask; one background thread runs the event loop in which the requests are sent.
"""

from __future__ import annotations

import asyncio
import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from pix2pred.structs import PictureError
from pix2pred.structs.views import View
from pix2pred.vlm.control.rate_limits import pause_after
from pix2pred.vlm.hosted.pricing import dollars
from pix2pred.vlm.model_spec import KEY_VARIABLES, HostedModel
from pix2pred.vlm.request import Answer, Finish, Request, Spent, Token, VLMError

if TYPE_CHECKING:
    from pydantic_ai.messages import ModelMessage, ModelResponse
    from pydantic_ai.models import Model, ModelRequestParameters
    from pydantic_ai.settings import ModelSettings

Draw = Callable[[View], bytes]
"""The PNG file of a view."""

_FINISHES = {"length": Finish.CUT_SHORT, "content_filter": Finish.REFUSED}
_SMALL_BUDGET = 2048
"""Tokens that every model can write: where they are too many, it is the pictures and the text that are too long."""
_ALTERNATIVES = 5
"""Tokens whose probabilities are asked for at every place."""


def key_of_provider(provider: str) -> str | None:
    """The provider's key, from the environment."""
    return next((os.environ[name] for name in KEY_VARIABLES[provider] if os.environ.get(name)), None)


class HostedVLM:
    """Asks a model over HTTP. ``hold`` is told how many seconds the provider wants no further requests."""

    def __init__(self, model: HostedModel, draw: Draw, timeout: float) -> None:
        self.name = model.name
        self.hold: Callable[[float], None] = lambda seconds: None
        self._model = model
        self._draw = draw
        self._timeout = timeout
        self._key = key_of_provider(model.provider)
        if self._key is None and not model.url:
            names = " or ".join(KEY_VARIABLES[model.provider])
            raise VLMError(f"{model.name}: no key; set the environment variable {names}")
        self._client = self._connect()
        self._loop = asyncio.new_event_loop()
        threading.Thread(target=self._loop.run_forever, name="pix2pred-vlm", daemon=True).start()

    def answer(self, request: Request) -> Answer:
        """Send the request once. Raises ``TransientError``, ``NoAnswerError`` or ``VLMError``.

        A model that allows no answer of this budget says so beforehand; the answer is then empty.
        """
        from pix2pred.vlm.hosted.failures import TooLargeError, translated

        messages, settings, parameters = self._messages(request), self._settings(request), _parameters(request)
        begin = time.perf_counter()
        try:
            coming = asyncio.run_coroutine_threadsafe(self._send(messages, settings, parameters), self._loop)
            self._prepare(request.upcoming, coming)
            response = coming.result()
        except Exception as error:  # every library below has exceptions of its own; their texts may hold the key
            failure = translated(error, self._model, self._key, self._timeout)
        else:
            return self._read(response, time.perf_counter() - begin)
        if isinstance(failure, TooLargeError) and request.max_tokens > _SMALL_BUDGET:
            return Answer("", finish=Finish.TOO_LARGE)
        raise failure from None

    def _connect(self) -> Model:
        try:
            from pix2pred.vlm.hosted.providers import connect
        except ImportError as error:
            raise VLMError(f"{self.name}: needs a package that is not installed ({error.name})") from error
        return connect(self._model, self._key, self._heard)

    def _heard(self, headers: dict[str, str]) -> None:
        if (seconds := pause_after(headers, time.time())) > 0:
            self.hold(seconds)

    async def _send(
        self, messages: list[ModelMessage], settings: ModelSettings, parameters: ModelRequestParameters
    ) -> ModelResponse:
        from pydantic_ai.direct import model_request

        sending = model_request(
            self._client, messages, model_settings=settings, model_request_parameters=parameters, instrument=False
        )
        return await asyncio.wait_for(sending, self._timeout)

    def _prepare(self, views: Sequence[View], coming: Future[ModelResponse]) -> None:
        """Draw ``views``, which the drawing keeps for later, until the answer is there."""
        for view in views:
            if coming.done():
                return
            with suppress(PictureError):  # told when the picture is needed
                self._draw(view)

    def _messages(self, request: Request) -> list[ModelMessage]:
        from pydantic_ai.messages import BinaryContent, ModelRequest, UserPromptPart

        content = [
            part
            if isinstance(part, str)  # without a name of our own, the library would compute one from the bytes
            else BinaryContent(self._draw(part), media_type="image/png", identifier=part.picture.image.digest[:8])
            for part in request.parts
        ]
        return [ModelRequest(parts=[UserPromptPart(content)])]

    def _settings(self, request: Request) -> ModelSettings:
        from pydantic_ai.settings import ModelSettings

        settings: dict[str, Any] = {
            "max_tokens": request.max_tokens,
            "temperature": request.temperature,
            "timeout": self._timeout,
        }
        if self._model.provider != "anthropic":
            settings["seed"] = 1000 * request.sample + request.attempt
        if self._model.provider != "google":
            settings["max_retries"] = 0
        if request.logprobs and self._model.provider in ("openai", "openai-compatible"):
            settings |= {"openai_logprobs": True, "openai_top_logprobs": _ALTERNATIVES}
        if request.logprobs and self._model.provider == "google":
            settings |= {"google_logprobs": True, "google_top_logprobs": _ALTERNATIVES}
        made: ModelSettings = ModelSettings(**settings)  # type: ignore[typeddict-item]
        return made

    def _read(self, response: ModelResponse, seconds: float) -> Answer:
        text = "".join(part.content for part in response.parts if part.part_kind == "text")
        details = response.provider_details or {}
        if refusal := details.get("refusal"):
            text = str(refusal)
        usage = response.usage
        spent = Spent(
            usage.input_tokens,
            usage.output_tokens,
            dollars(self._model.provider, self._model.model, usage.input_tokens, usage.output_tokens),
            seconds,
        )
        finish = _FINISHES.get(response.finish_reason or "", Finish.COMPLETE)
        return Answer(text, finish=finish, tokens=_tokens(details.get("logprobs"), text), spent=spent)


def _parameters(request: Request) -> ModelRequestParameters:
    from pydantic_ai.models import ModelRequestParameters
    from pydantic_ai.output import OutputObjectDefinition

    if not request.schema:
        return ModelRequestParameters()
    import json

    schema = OutputObjectDefinition(json_schema=json.loads(request.schema), name="labels", strict=True)
    return ModelRequestParameters(output_mode="native", output_object=schema, allow_text_output=True)


def _tokens(logprobs: Any, text: str) -> tuple[Token, ...]:
    """Tokens with their own probability first; empty when they are not there or do not make up the text."""
    if not isinstance(logprobs, list):
        return ()
    tokens = []
    for item in logprobs:
        alternatives = [(str(t["token"]), float(t["logprob"])) for t in item.get("top_logprobs") or ()]
        tokens.append(Token(str(item["token"]), ((str(item["token"]), float(item["logprob"])), *alternatives)))
    return tuple(tokens) if "".join(t.text for t in tokens) == text else ()
