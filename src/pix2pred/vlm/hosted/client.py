"""Hosted models and one's own servers, through ``pydantic_ai.direct``: one request, one answer, no repetition.

Threads ask; one background thread runs the event loop in which the requests are sent.
"""

from __future__ import annotations

import asyncio
import json
import logging
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from typing import TYPE_CHECKING, NoReturn

from pix2pred.structs import PictureError
from pix2pred.structs.views import View
from pix2pred.vlm.control.flow import FlowSettings, TransientError
from pix2pred.vlm.control.rate_limits import pause_after
from pix2pred.vlm.hosted.pricing import dollars
from pix2pred.vlm.hosted.probabilities import tokens_of as _tokens
from pix2pred.vlm.hosted.provider import HostedModel, Parameter
from pix2pred.vlm.hosted.spoken import spoken
from pix2pred.vlm.model_spec import Draw
from pix2pred.vlm.request import Answer, Finish, NoAnswerError, Request, Spent, VLMError

if TYPE_CHECKING:
    from pydantic_ai.messages import ModelMessage, ModelResponse
    from pydantic_ai.models import ModelRequestParameters
    from pydantic_ai.settings import ModelSettings

_FINISHES = {"length": Finish.CUT_SHORT, "content_filter": Finish.REFUSED}
"""All other reasons, unknown ones too, mean that the answer is complete."""
_SMALL_BUDGET = 2048
"""Tokens that every model can write: where they are too many, it is the pictures and the text that are too long."""
_RAISED = 16_384
"""Tokens for thinking that a model gets once it turned out to think longer than it may: what the longest of public
reports need for one picture question, and still allowed by models of 32,768 tokens."""


_CHARACTERS_IN_A_TOKEN = 6
"""More than any tokenizer makes of one token of our questions on average; pictures, which count too, are left out."""
_FEWEST_CHARACTERS = 1
"""Fewer characters of text for each token written mean that most of the tokens are thoughts which nobody sees."""
_SHORTEST_THOUGHTS = 100
"""Tokens: who writes fewer than these has thought little; some models write characters of several tokens each."""
_LOG = logging.getLogger("pix2pred")


class HostedVLM:
    """Asks a model over HTTP. ``hold`` is told how many seconds the provider wants no further requests.

    It remembers what the server does not take, and how many tokens the model needs for thinking.
    """

    def __init__(self, model: HostedModel, draw: Draw, flow: FlowSettings) -> None:
        self.name = model.name
        self.hold: Callable[[float], None] = lambda seconds: None
        self._model = model
        self._draw = draw
        self._flow = flow
        self._key = model.provider.key()
        if self._key is None and not model.url:
            raise VLMError(f"{model.name}: no key; set the environment variable {model.provider.keys_in_words}")
        if self._key and not (self._key.isascii() and self._key.isprintable()):
            raise VLMError(
                f"{model.name}: the key holds characters that no key has; check the environment variable "
                f"{model.provider.keys_in_words}"
            )
        own = model.provider.thinking_tokens(model.model)
        self._thinking = flow.thinking if flow.thinking is not None else own
        self._raised = False
        self._cut_told = False
        self._spoke = False
        self._left_out: frozenset[Parameter] = frozenset()
        self._learning = threading.Lock()
        self._connect()
        self._loop = asyncio.new_event_loop()
        threading.Thread(target=self._loop.run_forever, name="pix2pred-vlm", daemon=True).start()

    def answer(self, request: Request) -> Answer:
        """Send the request once, or again without what the server does not take.

        Raises ``TransientError``, ``NoAnswerError`` or ``VLMError``. A model that allows no answer of this budget says
        so beforehand; the answer is then empty.
        """
        from pix2pred.vlm.hosted.failures import TooLargeError, UnwantedError, programming_fault, translated

        self._check_pictures(request)
        while True:
            thinking, left_out = self._thinking, self._left_out
            begin, answered = time.perf_counter(), list[int]()
            try:
                response = self._exchange(request, thinking, left_out, answered)
            except Exception as error:  # every library below has exceptions of its own; their texts may hold the key
                if not answered and (fault := programming_fault(error, self.name, self._key)):
                    raise fault from None
                failure = translated(error, self._model, self._key, self._flow.timeout, request)
            else:
                return self._read(request, response, thinking, time.perf_counter() - begin)
            if isinstance(failure, UnwantedError) and failure.parameter not in left_out:
                self._leave_out(failure.parameter)
            elif isinstance(failure, TooLargeError) and thinking:
                self._think_less(thinking)
            elif isinstance(failure, TooLargeError) and request.max_tokens > _SMALL_BUDGET:
                return Answer("", finish=Finish.TOO_LARGE)
            else:
                raise failure from None

    def _check_pictures(self, request: Request) -> None:
        most = self._flow.max_pictures
        if most is not None and len(request.views) > most:
            raise VLMError(
                f"{request.about or 'a question'}: shows {len(request.views)} pictures, and 'flow: {{max_pictures: "
                f"{most}}}' allows {most}; labels show fewer with 'labels: {{crops: false}}' or fewer cameras"
            )

    def _connect(self) -> None:
        try:
            from pix2pred.vlm.hosted.http import http_client
        except ImportError as error:
            raise VLMError(f"{self.name}: needs a package that is not installed ({error.name})") from error
        self._client = self._model.connect(self._key or "", http_client(self._heard), self._left_out)

    def _heard(self, headers: dict[str, str]) -> None:
        if (seconds := pause_after(headers, time.time())) > 0:
            self.hold(seconds)

    def _leave_out(self, parameter: Parameter) -> None:
        with self._learning:
            if parameter not in self._left_out:
                self._left_out |= {parameter}
                self._connect()

    def _think_less(self, thinking: int) -> None:
        """Halve the room for thinking: together with the answer's budget it is more than the model allows."""
        with self._learning:
            if self._thinking == thinking:
                self._thinking = thinking // 2
                self._raised = True

    def _exchange(
        self, request: Request, thinking: int, left_out: frozenset[Parameter], answered: list[int]
    ) -> ModelResponse:
        messages, settings = self._messages(request), self._settings(request, thinking, left_out)
        parameters = _parameters(request, left_out)
        coming = asyncio.run_coroutine_threadsafe(self._send(messages, settings, parameters, answered), self._loop)
        self._prepare(request.upcoming, coming)
        return coming.result()

    async def _send(
        self,
        messages: list[ModelMessage],
        settings: ModelSettings,
        parameters: ModelRequestParameters,
        answered: list[int],
    ) -> ModelResponse:
        from pydantic_ai.direct import model_request

        from pix2pred.vlm.hosted.http import ANSWERED

        ANSWERED.set(answered)
        sending = model_request(
            self._client, messages, model_settings=settings, model_request_parameters=parameters, instrument=False
        )
        return await asyncio.wait_for(sending, self._flow.timeout)

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

    def _settings(self, request: Request, thinking: int, left_out: frozenset[Parameter]) -> ModelSettings:
        from pydantic_ai.settings import ModelSettings

        provider, flow = self._model.provider, self._flow
        asked = thinking if flow.thinking is not None or thinking else None
        settings = provider.settings(request, asked, left_out)
        settings |= {"max_tokens": self._budget(request, thinking), "timeout": flow.timeout}
        left = Parameter.TEMPERATURE in left_out or flow.temperature is None
        if not left and provider.takes_temperature(self._model.model, asked):
            settings["temperature"] = request.temperature
        made: ModelSettings = ModelSettings(**settings)  # type: ignore[typeddict-item]
        return made

    def budget(self, request: Request) -> int:
        """Tokens that the model may write and think about ``request``, were it asked now."""
        return self._budget(request, self._thinking)

    def _budget(self, request: Request, thinking: int) -> int:
        return (self._flow.output_tokens or request.max_tokens) + thinking

    def _read(self, request: Request, response: ModelResponse, thinking: int, seconds: float) -> Answer:
        text, unfinished = spoken("".join(part.content for part in response.parts if part.part_kind == "text"))
        details = response.provider_details or {}
        usage = response.usage
        cached = min(usage.cache_read_tokens, usage.input_tokens)
        price = dollars(self._model.provider.name, self._model.model, usage.input_tokens, usage.output_tokens, cached)
        spent = Spent(usage.input_tokens, usage.output_tokens, price, seconds, cached)
        self._note_cut(request, usage.input_tokens)
        if refusal := details.get("refusal"):
            return Answer(str(refusal), finish=Finish.REFUSED, spent=spent)
        spoke = bool(text.strip())
        finish = Finish.CUT_SHORT if unfinished else _FINISHES.get(response.finish_reason or "", Finish.COMPLETE)
        if not spoke and usage.output_tokens >= self._budget(request, thinking):
            finish = Finish.CUT_SHORT  # whatever the server calls it
        if finish == Finish.CUT_SHORT and (not spoke or self._thought_away(text, usage.output_tokens)):
            self._never_spoke(thinking, spent, spoke)
        if not spoke and any(part.part_kind == "thinking" for part in response.parts):
            raise _only_thought(spent)
        self._spoke |= spoke
        return Answer(text, finish=finish, tokens=_tokens(details.get("logprobs"), text), spent=spent)

    def _note_cut(self, request: Request, counted: int) -> None:
        """Warn, once, of a server that reads less of a question than there is: it cuts what its context lacks."""
        characters = len(request.text)
        if 0 < counted * _CHARACTERS_IN_A_TOKEN < characters and not self._cut_told:
            self._cut_told = True
            _LOG.warning(
                "%s: %s has %d characters and %d pictures, and the server counted %d tokens: it cuts questions "
                "silently, and labels are then answers to something else. Start it with a longer context (Ollama: "
                "num_ctx, llama.cpp: --ctx-size, vLLM: --max-model-len) and run again with --mode live",
                self.name, request.about or "a question", characters, len(request.views), counted,
            )  # fmt: skip

    def _thought_away(self, text: str, written: int) -> bool:
        """Whether most of what was written is no text, and more room for it was not given yet."""
        hidden = written >= _SHORTEST_THOUGHTS and len(text) < _FEWEST_CHARACTERS * written
        return hidden and not self._raised

    def _never_spoke(self, thinking: int, spent: Spent, spoke: bool) -> NoReturn:
        """An answer was cut short before it said anything, or much: give more room for thinking, once.

        Raises ``TransientError`` when the question is to be asked again, and ``VLMError`` when that was tried and the
        model has never said anything, or else ``NoAnswerError``.
        """
        error: VLMError = NoAnswerError("the answer was cut short by the token budget before it said anything")
        with self._learning:
            if not self._raised:
                self._raised = True
                self._thinking = max(4 * thinking, _RAISED)
            if self._thinking > thinking:
                much = "much" if spoke else "anything"
                said = f"the answer was cut short after {spent.output_tokens} tokens, before it said {much}"
                error = TransientError(said, retry_after=0.0)
            elif not self._spoke:
                error = VLMError(
                    f"{self.name}: answers are cut short by the token budget before they say anything, also with "
                    f"{thinking} tokens for thinking; set 'flow: {{thinking: N}}' to more than that, or to 0 for a "
                    "model that can answer without thinking, and start the server with a longer context if it has one"
                )
        error.spent = spent
        raise error


def _only_thought(spent: Spent) -> NoAnswerError:
    error = NoAnswerError(
        "the answer holds thinking and no text; a server that sorts thinking out may take all of an answer for it "
        "(vLLM: --reasoning-parser)"
    )
    error.spent = spent
    return error


def _parameters(request: Request, left_out: frozenset[Parameter]) -> ModelRequestParameters:
    from pydantic_ai.models import ModelRequestParameters
    from pydantic_ai.output import OutputObjectDefinition

    if not request.schema or Parameter.SCHEMA in left_out:
        return ModelRequestParameters()
    schema = OutputObjectDefinition(json_schema=json.loads(request.schema), name="labels", strict=True)
    return ModelRequestParameters(output_mode="native", output_object=schema, allow_text_output=True)
