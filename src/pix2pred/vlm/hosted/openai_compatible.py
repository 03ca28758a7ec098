"""Servers of one's own, and others', that speak OpenAI's chat completions: vLLM, Ollama, llama.cpp, proxies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pix2pred.vlm.hosted.openai import OpenAI
from pix2pred.vlm.hosted.provider import Parameter

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model


_NO_TAGS = ("\x00think", "\x00/think")
"""Marks that stand in no answer: the client library would drop a beginning of thinking that has no end."""


class OpenAICompatible(OpenAI):
    """A model at an address. Pictures count in many ways; they are taken to count as at OpenAI."""

    name = "openai-compatible"
    form = "openai-compatible:MODEL@URL"
    key_variables = ("PIX2PRED_API_KEY",)
    has_address = True

    def client(self, model: str, url: str, key: str, http: httpx2.AsyncClient, left_out: frozenset[Parameter]) -> Model:
        from pydantic_ai.models.openai import OpenAIChatModel
        from pydantic_ai.profiles.openai import OpenAIModelProfile
        from pydantic_ai.providers.openai_compatible import OpenAICompatibleProvider

        profile = OpenAIModelProfile(  # the older name of the budget is the one nearly every server knows
            openai_chat_supports_max_completion_tokens=Parameter.BUDGET_NAME in left_out,
            supports_json_schema_output=True,
            thinking_tags=_NO_TAGS,
        )
        provider = OpenAICompatibleProvider(
            "openai-compatible", base_url=url, api_key=key or None, http_client=http, profile=profile
        )
        return OpenAIChatModel(model, provider=provider)

    def thinking_tokens(self, model: str) -> int:
        """Whether a model of any name thinks is found out when an answer is cut short before it says anything."""
        return 0

    def takes_temperature(self, model: str, thinking: int | None) -> bool:
        return True
