"""Anthropic."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Any

from pix2pred.vlm.hosted.provider import Parameter, Provider
from pix2pred.vlm.request import Request

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model

_LEAST_THOUGHTS = 1024
"""Tokens: the smallest budget for thinking that the interface takes."""


class Anthropic(Provider):
    """Models of Anthropic. They think only when asked to, take no seed and give no probabilities."""

    name = "anthropic"
    form = "anthropic:MODEL"
    key_variables = ("ANTHROPIC_API_KEY",)

    def client(self, model: str, url: str, key: str, http: httpx2.AsyncClient, left_out: frozenset[Parameter]) -> Model:
        from pydantic_ai.models.anthropic import AnthropicModel
        from pydantic_ai.providers.anthropic import AnthropicProvider

        return AnthropicModel(model, provider=AnthropicProvider(api_key=key, http_client=http))

    def settings(self, request: Request, thinking: int | None, left_out: frozenset[Parameter]) -> dict[str, Any]:
        made: dict[str, Any] = {"max_retries": 0}
        if thinking and Parameter.THINKING not in left_out:
            made["anthropic_thinking"] = {"type": "enabled", "budget_tokens": max(thinking, _LEAST_THOUGHTS)}
        return made

    def takes_temperature(self, model: str, thinking: int | None) -> bool:
        from pydantic_ai.profiles.anthropic import anthropic_model_profile

        return not thinking and not (anthropic_model_profile(model) or {}).get("anthropic_disallows_sampling_settings")

    def picture_tokens(self, width: int, height: int) -> int:
        """One for 750 pixels, of a picture shrunk to at most 1568 on its longer side."""
        factor = min(1.0, 1568 / max(width, height))
        return ceil(width * factor * height * factor / 750)
