"""What went wrong with a request, by what can be done: ask again, ask otherwise, leave this question, end the run.

Only what a server said in its error message is passed on, shortened, with the key blotted out and nothing in it that
a terminal would obey; exceptions of the libraries below hold requests and headers, so they are not kept as causes.
"""

from __future__ import annotations

import json
import re
import traceback
from collections.abc import Iterator
from http import HTTPStatus
from pathlib import Path
from typing import Any

from pydantic_ai import exceptions as ai

from pix2pred.vlm.control.flow import TransientError
from pix2pred.vlm.hosted.http import ElsewhereError, NoDocumentError, OversizeError
from pix2pred.vlm.hosted.provider import HostedModel, Parameter
from pix2pred.vlm.request import NoAnswerError, Request, VLMError


class TooLargeError(NoAnswerError):
    """The answer budget, or all of the request, is larger than the model allows: fewer atoms may fit."""


class UnwantedError(NoAnswerError):
    """The server does not take ``parameter``; the question may be asked without it."""

    def __init__(self, message: str, parameter: Parameter) -> None:
        super().__init__(message)
        self.parameter = parameter


_TOO_LARGE = re.compile(r"\bmax_?(completion_?|output_?)?tokens\b|context (length|size|window)", re.I)
_NOT_THERE = re.compile(r"unsupported|not supported|unknown parameter|unrecognized", re.I)
_UNKNOWN_MODEL = re.compile(
    r"\bmodel\b.{0,200}(not found|not exist|unknown|not available|no such)"
    r"|\b(?:not a valid|unknown|no such) model\b|\binvalid model (?:id|name|identifier)",
    re.I,
)
_ABSENT_MODEL = re.compile(r"\bmodel\b.{0,200}(?:not found|not exist)", re.I)
"""The same, in words that no overloaded server uses."""
_NO_CREDIT = re.compile(
    r"credit balance|(?:insufficient|not enough|no|out of|more) (?:credits?|funds|balance)\b|key limit exceeded"
    r"|payment required|\b(?:credits?|balance|quota) (?:is|are|has been)?\s?(?:used up|exhausted|too low|exceeded)",
    re.I,
)
_PINNED_MODEL = re.compile(r"(pinned|restricted) to\b|only serves", re.I)
_PARAMETERS = {
    Parameter.TEMPERATURE: re.compile(r"\btemperature\b", re.I),
    Parameter.SEED: re.compile(r"\bseed\b", re.I),
    Parameter.LOGPROBS: re.compile(r"\b(top_|response_?)?logprobs\b|log.?probabilit", re.I),
    Parameter.SCHEMA: re.compile(r"response_?format|json_?schema|response_?schema|structured output|\bguided", re.I),
    Parameter.THINKING: re.compile(r"thinking|reasoning_?effort|budget_tokens", re.I),
}
_OTHER_BUDGET = re.compile(r"max_(completion_)?tokens\b.{0,120}(unsupported|not supported|instead|use)", re.I)
_PICTURES = r"(?:\b(?:image|vision|picture|visual|multi-?modal)|image_url)"
_UNABLE = r"(?:\b(?:no|not|cannot|unable|unsupported|unknown|missing|disabled|only (?:support|accept|by|model))\b|n't)"
_TAKE = r"(?:support|accept|take|have|content|variant|required|is an?\b|an?\b)"
_NO_IMAGES = re.compile(
    rf"mmproj|text.only|language.only|no {_PICTURES}|unknown .{{0,30}}image_url"
    rf"|{_UNABLE}.{{0,40}}{_TAKE}.{{0,25}}{_PICTURES}|{_PICTURES}.{{0,20}}disabled"
    rf"|{_PICTURES}.{{0,60}}(?:not|n't|only|un)[ -]?(?:be )?(?:support|accept|allow|enabled|available)",
    re.I,
)
_OTHER_FAULT = re.compile(
    r"\bformats?\b|mime|media.?type|too (?:large|big|small)|\bsize|pixels|bytes|decod|corrupt|could not process", re.I
)
"""A picture is at fault, not all pictures."""
_NO_MEMORY = re.compile(
    r"out of memory|(requires|needs) more .{0,20}memory|(insufficient|not enough) .{0,20}memory|CUDA error"
    r"|failed to (load|allocate)|unable to (load|allocate)",
    re.I,
)
_TOO_MANY_PICTURES = re.compile(
    r"too many (?:image|picture)|(?:number|amount) of (?:image|picture)s|many-image|limit-mm-per-prompt"
    r"|(?:images|pictures)\b.{0,60}(?:exceed|limit|maximum|at most)"
    r"|(?:at most|up to|max(?:imum)?(?: of)?|limit(?:ed)?(?: is| of| to)?:?|only|more than) ?\d+ ?(?:image|picture)",
    re.I,
)
_LARGE_PICTURE = re.compile(
    r"\b(?:image|picture)\b.{0,80}(?:exceed|too (?:large|big)|larger than|at most|maximum).{0,60}"
    r"(?:\bMi?B|bytes|pixel|px|size)"
    r"|\b(?:image|picture) (?:size|dimension)s?.{0,40}(?:exceed|too (?:large|big)|larger|limit)",
    re.I,
)
_NUMBER = re.compile(r"(?<![\d.])\d{1,3}(?![\d.]*\d)")
_CERTIFICATE = re.compile(r"certificate|CERTIFICATE_VERIFY_FAILED|self.signed", re.I)
_MISTAKES = (TypeError, AttributeError, NameError, LookupError, AssertionError, NotImplementedError, ImportError)
_MARKUP = re.compile(r"</?[A-Za-z][^<>]{0,200}>")
"""Marks of a page, which proxies send in place of a message."""
_READ_OF_A_MESSAGE = 2000
"""Characters of a server's message that are looked at."""
_SHOWN_OF_A_MESSAGE = 200


def translated(error: Exception, model: HostedModel, key: str | None, timeout: float, request: Request) -> VLMError:
    """The error to raise in place of ``error``, which ``request`` met."""
    chain = list(_causes(error))
    if any(isinstance(e, OversizeError) for e in chain):
        return NoAnswerError("the answer is larger than any answer can be")
    if elsewhere := next((e for e in chain if isinstance(e, ElsewhereError)), None):
        return VLMError(
            f"{model.name}: {model.place} sends questions elsewhere, to "
            f"{_message(str(elsewhere), key)[:_SHOWN_OF_A_MESSAGE]}, where they were not sent; name the address that "
            "answers in --vlm, or log in where it leads"
        )
    if strange := next((e for e in chain if isinstance(e, NoDocumentError)), None):
        return TransientError(
            f"{model.place} answers with {strange}, as a log-in page, a proxy or another program does", connected=False
        )
    if any(_CERTIFICATE.search(str(e)[:_READ_OF_A_MESSAGE]) for e in chain if isinstance(e, OSError)):
        return VLMError(
            f"{model.name}: the certificate of {model.place} is not trusted; name a file with the certificate in the "
            "environment variable SSL_CERT_FILE, or use http:// on this machine"
        )
    if isinstance(error, TimeoutError | ai.ModelRequestTimeout | ai.ModelTimeoutError):
        more = "'flow: {timeout: N}' in --config gives it longer"
        return TransientError(f"no answer within {timeout:g} s ({more})", connected=False)
    if isinstance(error, ai.ModelConnectionError):
        connected = error.phase not in ("connect", "pool")
        what = "the connection was cut" if connected else f"nothing can be reached at {model.place}"
        return TransientError(what, connected=connected)
    if isinstance(error, ai.ModelAPIError):
        return _refused(error, model, key, request)
    if isinstance(error, ai.UnexpectedModelBehavior):
        return TransientError("the server's answer does not follow the protocol")
    return TransientError(f"the request failed ({type(error).__name__})")


def programming_fault(error: Exception, name: str, key: str | None) -> VLMError | None:
    """The error that ends the run if ``error``, met before any server answered, is a mistake in a program.

    No repetition mends such a one. It is named with its place, for whoever mends it.
    """
    if not isinstance(error, _MISTAKES):
        return None
    frames = traceback.extract_tb(error.__traceback__)
    place = f" in {Path(frames[-1].filename).name}, line {frames[-1].lineno}" if frames else ""
    return VLMError(
        f"{name}: a fault in this program or a library below it, not in the server: {type(error).__name__}{place}: "
        f"{_message(str(error), key)[:_SHOWN_OF_A_MESSAGE]}; no question was sent. Report it; until it is mended, "
        "another version of the packages 'pydantic-ai-slim' and of the provider's own may help"
    )


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def _refused(error: ai.ModelAPIError, model: HostedModel, key: str | None, request: Request) -> VLMError:
    status = error.status_code if isinstance(error, ai.ModelHTTPError) else None
    said = f"HTTP {status}" if status else "the provider reported an error"
    whole = _message(error.body, key)
    if whole:
        said += f": {whole[:_SHOWN_OF_A_MESSAGE]}"
    if (
        isinstance(error, ai.ModelQuotaExceededError)
        or status == 402
        or (status in (400, 403) and _NO_CREDIT.search(whole))
    ):
        return VLMError(f"{model.name}: the account's quota or credit is used up ({said})")
    if isinstance(error, ai.ModelAuthenticationError) or status in (401, 403):
        names = model.provider.keys_in_words
        return VLMError(f"{model.name}: the key was not accepted ({said}); check the environment variable {names}")
    if lasting := _lasting(whole, status, model, said, request):
        return lasting
    unknown = _UNKNOWN_MODEL.search(whole) or _PINNED_MODEL.search(whole)
    absent = status == 500 and _ABSENT_MODEL.search(whole)
    if isinstance(error, ai.ModelNotFoundError) or status == 404 or (status in (400, 422) and unknown) or absent:
        return VLMError(f"{model.name}: the server knows no such model or address ({said})")
    if status is None or status >= 500 or status in (408, 409, 425, 429):
        return TransientError(said, error.retry_after)
    if status in (400, 413, 422):
        if unwanted := _unwanted(whole, request):
            return UnwantedError(said, unwanted)
        if _TOO_LARGE.search(whole) and not _NOT_THERE.search(whole):
            return TooLargeError(said)
    return NoAnswerError(said)


def _lasting(message: str, status: int | None, model: HostedModel, said: str, request: Request) -> VLMError | None:
    """What no waiting mends and every question meets."""
    count = len(request.views)
    many = count and "many-image" in message.lower()
    if count and not many and _LARGE_PICTURE.search(message):
        return VLMError(
            f"{model.name}: a picture is larger than the server takes ({said}); show smaller pictures with "
            "--longest-side"
        )
    if count and _TOO_MANY_PICTURES.search(message):
        number = max((n for n in map(int, _NUMBER.findall(message)) if 0 < n < max(count, 2)), default=None)
        remedy = (
            "a question about a change shows at least two, before and after: name another model"
            if number == 1
            else f"set 'flow: {{max_pictures: {number or 'N'}}}', which asks for proposals in parts, and with it "
            "'labels: {crops: false}' for fewer pictures of labels"
        )
        return VLMError(
            f"{model.name}: {count} pictures in one question are too many ({said}); {remedy}. A vLLM server takes more "
            "with --limit-mm-per-prompt"
        )
    if status == HTTPStatus.REQUEST_ENTITY_TOO_LARGE and not _TOO_LARGE.search(message):
        return VLMError(
            f"{model.name}: the question with its {count} pictures is more than the server or a proxy before it takes "
            f"({said}); show smaller pictures with --longest-side, or fewer with 'flow: {{max_pictures: N}}'"
        )
    if count and _NO_IMAGES.search(message) and not _OTHER_FAULT.search(message):
        return VLMError(
            f"{model.name}: the model or its server takes no pictures ({said}); name a vision-language model, or start "
            "the server with the model's image projector (llama.cpp: --mmproj)"
        )
    if _NO_MEMORY.search(message):
        return VLMError(f"{model.name}: the server lacks memory for this model or question ({said})")
    return None


def _unwanted(message: str, request: Request) -> Parameter | None:
    """The parameter that the server does not take, of those that were sent."""
    if _OTHER_BUDGET.search(message):
        return Parameter.BUDGET_NAME
    sent = {p for p, pattern in _PARAMETERS.items() if pattern.search(message)}
    if not request.logprobs:
        sent.discard(Parameter.LOGPROBS)
    if not request.schema:
        sent.discard(Parameter.SCHEMA)
    return min(sent, key=list(_PARAMETERS).index, default=None)


def _message(body: Any, key: str | None) -> str:
    """The message in a provider's error body, on one line, at most ``_READ_OF_A_MESSAGE`` characters."""
    if isinstance(body, dict):
        inner = body.get("error", body)
        found = inner.get("message") or inner.get("detail") if isinstance(inner, dict) else inner
        body = found or body.get("detail") or body
    try:
        text = body if isinstance(body, str) else json.dumps(body, default=str) if body else ""
    except (ValueError, RecursionError):  # nested deeper than anything that says something
        return ""
    text = _MARKUP.sub(" ", text[:_READ_OF_A_MESSAGE])
    plain = "".join(c if c.isprintable() else " " for c in text)
    return _blotted(" ".join(plain.split()), key)


def _blotted(text: str, key: str | None) -> str:
    """Without the key, nor the beginning or end of it that servers like to repeat. Takes linear time."""
    if key:
        text = text.replace(key, "[key]")
        if len(key) >= 8:
            pieces = (key[:8], key[-4:])
            text = " ".join("[key]" if any(p in word for p in pieces) else word for word in text.split(" "))
    return re.sub(r"\b(?:sk|pk|key|AIza)[-_A-Za-z0-9]{12,}", "[key]", text)
