"""The clients of the providers, made with a key from the environment. Imported only when a hosted model is asked."""

from __future__ import annotations

from collections.abc import Callable

import httpx2
from pydantic_ai.models import Model

from pix2pred.vlm.model_spec import HostedModel
from pix2pred.vlm.request import VLMError

Heard = Callable[[dict[str, str]], None]
"""Told the headers of every response, names in lower case."""


def connect(model: HostedModel, key: str | None, heard: Heard) -> Model:
    """A client of the model. Raises ``VLMError`` naming the extra to install when a package is missing."""

    async def listen(response: httpx2.Response) -> None:
        if response.status_code < 400:  # failures bring their own waiting time
            heard({name.lower(): value for name, value in response.headers.items()})

    http = httpx2.AsyncClient(timeout=httpx2.Timeout(600.0, connect=10.0), event_hooks={"response": [listen]})
    try:
        return _MAKERS[model.provider](model, key or "", http)
    except ImportError as error:
        raise VLMError(f"{model.name}: needs pip install 'pix2pred[{model.provider}]' ({error.name})") from error


def _openai(model: HostedModel, key: str, http: httpx2.AsyncClient) -> Model:
    from pydantic_ai.models.openai import OpenAIChatModel
    from pydantic_ai.providers.openai import OpenAIProvider

    return OpenAIChatModel(model.model, provider=OpenAIProvider(api_key=key, http_client=http))


def _openai_compatible(model: HostedModel, key: str, http: httpx2.AsyncClient) -> Model:
    from pydantic_ai.models.openai import OpenAIChatModel
    from pydantic_ai.profiles.openai import OpenAIModelProfile
    from pydantic_ai.providers.openai_compatible import OpenAICompatibleProvider

    # the older name of the budget is the one every server knows
    profile = OpenAIModelProfile(openai_chat_supports_max_completion_tokens=False, supports_json_schema_output=True)
    provider = OpenAICompatibleProvider(
        "openai-compatible", base_url=model.url, api_key=key or None, http_client=http, profile=profile
    )
    return OpenAIChatModel(model.model, provider=provider)


def _anthropic(model: HostedModel, key: str, http: httpx2.AsyncClient) -> Model:
    from pydantic_ai.models.anthropic import AnthropicModel
    from pydantic_ai.providers.anthropic import AnthropicProvider

    return AnthropicModel(model.model, provider=AnthropicProvider(api_key=key, http_client=http))


def _google(model: HostedModel, key: str, http: httpx2.AsyncClient) -> Model:
    from pydantic_ai.models.google import GoogleModel
    from pydantic_ai.providers.google import GoogleProvider

    return GoogleModel(model.model, provider=GoogleProvider(api_key=key, http_client=http))


_MAKERS: dict[str, Callable[[HostedModel, str, httpx2.AsyncClient], Model]] = {
    "openai": _openai,
    "openai-compatible": _openai_compatible,
    "anthropic": _anthropic,
    "google": _google,
}
