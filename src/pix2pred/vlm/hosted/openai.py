"""OpenAI."""

from __future__ import annotations

import re
from math import ceil
from typing import TYPE_CHECKING, Any

from pix2pred.vlm.hosted.provider import LIKELY_TOKENS, Parameter, Provider
from pix2pred.vlm.request import Request

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model

_THINKS = re.compile(r"o\d|gpt-[5-9]")
"""Beginnings of names of models that think before they speak; thinking counts towards the answer's budget."""
_THOUGHTS = 4096
"""Tokens of thinking about one question that are expected, at the provider's default effort."""


_LEAST_CACHED, _CACHED_STEP = 1024, 128
"""Tokens: the shortest beginning that is kept in the prompt cache, and the steps in which it is."""


class OpenAI(Provider):
    """Models of OpenAI, through chat completions."""

    name = "openai"
    form = "openai:MODEL"
    key_variables = ("OPENAI_API_KEY",)

    def client(self, model: str, url: str, key: str, http: httpx2.AsyncClient, left_out: frozenset[Parameter]) -> Model:
        from pydantic_ai.models.openai import OpenAIChatModel
        from pydantic_ai.providers.openai import OpenAIProvider

        return OpenAIChatModel(model, provider=OpenAIProvider(api_key=key, http_client=http))

    def thinking_tokens(self, model: str) -> int:
        return _THOUGHTS if _THINKS.match(model) and "chat" not in model else 0

    def takes_temperature(self, model: str, thinking: int | None) -> bool:
        return not thinking

    def settings(self, request: Request, thinking: int | None, left_out: frozenset[Parameter]) -> dict[str, Any]:
        made = super().settings(request, thinking, left_out)
        if request.logprobs and Parameter.LOGPROBS not in left_out:
            made |= {"openai_logprobs": True, "openai_top_logprobs": LIKELY_TOKENS}
        if thinking == 0 and Parameter.THINKING not in left_out:
            made["thinking"] = False
        return made

    def cached_tokens(self, repeated: int) -> int:
        return repeated // _CACHED_STEP * _CACHED_STEP if repeated >= _LEAST_CACHED else 0

    def picture_tokens(self, width: int, height: int) -> int:
        """85, and 170 for each tile of 512 pixels once the picture fits into 2048 and its shorter side into 768."""
        factor = min(1.0, 2048 / max(width, height))
        factor *= min(1.0, 768 / (min(width, height) * factor))
        return 85 + 170 * ceil(width * factor / 512) * ceil(height * factor / 512)
