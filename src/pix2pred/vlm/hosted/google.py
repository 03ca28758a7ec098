"""Google's Gemini."""

from __future__ import annotations

import re
from math import ceil
from typing import TYPE_CHECKING, Any

from pix2pred.vlm.hosted.provider import LIKELY_TOKENS, Parameter, Provider
from pix2pred.vlm.request import Request

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model

_THINKS = re.compile(r"gemini-(2\.5|[3-9])")
"""Beginnings of names of models that think unless told otherwise; thinking counts towards the answer's budget."""
_THOUGHTS = 8192
"""Tokens of thinking that are asked for as the limit about one question: the provider's own is up to 24,576."""


class Google(Provider):
    """Models of Google. Its client repeats nothing by itself."""

    name = "google"
    form = "google:MODEL"
    key_variables = ("GOOGLE_API_KEY", "GEMINI_API_KEY")

    def client(self, model: str, url: str, key: str, http: httpx2.AsyncClient, left_out: frozenset[Parameter]) -> Model:
        from pydantic_ai.models.google import GoogleModel
        from pydantic_ai.providers.google import GoogleProvider

        return GoogleModel(model, provider=GoogleProvider(api_key=key, http_client=http))

    def thinking_tokens(self, model: str) -> int:
        return _THOUGHTS if _THINKS.match(model) else 0

    def settings(self, request: Request, thinking: int | None, left_out: frozenset[Parameter]) -> dict[str, Any]:
        made = super().settings(request, thinking, left_out)
        del made["max_retries"]
        if request.logprobs and Parameter.LOGPROBS not in left_out:
            made |= {"google_logprobs": True, "google_top_logprobs": LIKELY_TOKENS}
        if thinking is not None and Parameter.THINKING not in left_out:
            made["google_thinking_config"] = {"thinking_budget": thinking}
        return made

    def picture_tokens(self, width: int, height: int) -> int:
        """258, for every tile of 768 pixels when a side is longer than 384."""
        return 258 if max(width, height) <= 384 else 258 * ceil(width / 768) * ceil(height / 768)
