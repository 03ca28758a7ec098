"""What went wrong with a request, in three kinds: it may pass, this question has no answer, nothing can work.

Only what a server said in its error message is passed on, shortened, with the key blotted out; exceptions of the
libraries below hold requests and headers, so they are not kept as causes.
"""

from __future__ import annotations

import json
import re
from typing import Any

from pydantic_ai import exceptions as ai

from pix2pred.vlm.control.flow import TransientError
from pix2pred.vlm.model_spec import KEY_VARIABLES, HostedModel
from pix2pred.vlm.request import NoAnswerError, VLMError


class TooLargeError(NoAnswerError):
    """The answer budget, or all of the request, is larger than the model allows: fewer atoms may fit."""


_TOO_LARGE = re.compile(r"\bmax_?(completion_?|output_?)?tokens\b|context (length|size|window)", re.I)
_NOT_THERE = re.compile(r"unsupported|not supported|unknown parameter|unrecognized", re.I)
_UNKNOWN_MODEL = re.compile(r"\bmodel\b.{0,200}(not found|not exist|unknown|not supported|not available|no such)", re.I)
_PINNED_MODEL = re.compile(r"(pinned|restricted) to\b|only serves", re.I)


def translated(error: Exception, model: HostedModel, key: str | None, timeout: float) -> VLMError:
    """The error to raise in place of ``error``."""
    if isinstance(error, TimeoutError | ai.ModelRequestTimeout | ai.ModelTimeoutError):
        return TransientError(f"no answer within {timeout:g} s")
    if isinstance(error, ai.ModelConnectionError):
        connected = error.phase not in ("connect", "pool")
        what = "the connection was cut" if connected else f"nothing can be reached at {model.url or model.provider}"
        return TransientError(what, connected=connected)
    if isinstance(error, ai.ModelAPIError):
        return _refused(error, model, key)
    if isinstance(error, ai.UnexpectedModelBehavior):
        return TransientError("the server's answer does not follow the protocol")
    return TransientError(f"the request failed ({type(error).__name__})")


def _refused(error: ai.ModelAPIError, model: HostedModel, key: str | None) -> VLMError:
    status = error.status_code if isinstance(error, ai.ModelHTTPError) else None
    said = f"HTTP {status}" if status else "the provider reported an error"
    if message := _message(error.body, key):
        said += f": {message}"
    if isinstance(error, ai.ModelAuthenticationError) or status in (401, 403):
        names = " or ".join(KEY_VARIABLES[model.provider])
        return VLMError(f"{model.name}: the key was not accepted ({said}); check the environment variable {names}")
    if isinstance(error, ai.ModelQuotaExceededError) or status == 402:
        return VLMError(f"{model.name}: the account's quota or credit is used up ({said})")
    unknown = _UNKNOWN_MODEL.search(message) or _PINNED_MODEL.search(message)
    if isinstance(error, ai.ModelNotFoundError) or status == 404 or (status == 400 and unknown):
        return VLMError(f"{model.name}: the server knows no such model or address ({said})")
    if status is None or status >= 500 or status in (408, 409, 425, 429):
        return TransientError(said, error.retry_after)
    too_large = _TOO_LARGE.search(message) and not _NOT_THERE.search(message)
    return TooLargeError(said) if status in (400, 413, 422) and too_large else NoAnswerError(said)


def _message(body: Any, key: str | None) -> str:
    """The message in a provider's error body, on one line."""
    if isinstance(body, dict):
        inner = body.get("error", body)
        found = inner.get("message") or inner.get("detail") if isinstance(inner, dict) else inner
        body = found or body.get("detail") or body
    text = " ".join((body if isinstance(body, str) else json.dumps(body, default=str)).split()) if body else ""
    return _blotted(text, key)[:200]


def _blotted(text: str, key: str | None) -> str:
    """Without the key, nor the beginning or end of it that servers like to repeat."""
    if key:
        text = text.replace(key, "[key]")
        if len(key) >= 8:
            text = re.sub(rf"\S*(?:{re.escape(key[:8])}|{re.escape(key[-4:])})\S*", "[key]", text)
    return re.sub(r"\b(?:sk|pk|key|AIza)[-_A-Za-z0-9]{12,}", "[key]", text)
