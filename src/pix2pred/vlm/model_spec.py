"""The names of models on the command line: ``openai:gpt-4o``, ``openai-compatible:MODEL@URL``, ``mailbox:DIR``."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import urlsplit

from pix2pred.system.errors import Pix2predError

KEY_VARIABLES = {
    "openai": ("OPENAI_API_KEY",),
    "google": ("GOOGLE_API_KEY", "GEMINI_API_KEY"),
    "anthropic": ("ANTHROPIC_API_KEY",),
    "openai-compatible": ("PIX2PRED_API_KEY",),
}
"""Environment variables that hold a provider's key, the first that is set; keys come from nowhere else."""

FORMS = "offline, openai:MODEL, google:MODEL, anthropic:MODEL, openai-compatible:MODEL@URL, replay:DIR, mailbox:DIR"


class ModelNameError(Pix2predError, ValueError):
    """A name that says no model; the message says which forms there are."""


@dataclass(frozen=True, slots=True)
class HostedModel:
    """A model behind HTTP. ``url`` is empty for the providers that have one address."""

    provider: str
    model: str
    url: str = ""

    @property
    def name(self) -> str:
        """What stands in stored answers: no address, so that a store replays wherever the model is served from."""
        return f"{self.provider}:{self.model}"


def hosted_model(spec: str) -> HostedModel:
    """Read ``PROVIDER:MODEL`` or ``openai-compatible:MODEL@URL``. Raises ``ModelNameError``."""
    provider, _, rest = spec.partition(":")
    if provider not in KEY_VARIABLES or not rest:
        raise ModelNameError(f"--vlm {_shown(spec)}: is not one of {FORMS}")
    if provider != "openai-compatible":
        return HostedModel(provider, rest)
    model, at, url = rest.partition("@http")
    url = f"http{url}"
    parts = urlsplit(url)
    if not at or not model or parts.scheme not in ("http", "https") or not parts.hostname:
        raise ModelNameError(
            f"--vlm {_shown(spec)}: write openai-compatible:MODEL@URL, such as "
            "openai-compatible:qwen2.5-vl@http://localhost:8000/v1"
        )
    if parts.username or parts.password or parts.query:
        raise ModelNameError(
            "--vlm: an address with a name, password or key in it would be written into the run folder; "
            f"put the key into the environment variable {KEY_VARIABLES[provider][0]}"
        )
    return HostedModel(provider, model, url.rstrip("/"))


def _shown(spec: str) -> str:
    """The name for an error message, without what could be a password."""
    head, at, tail = spec.rpartition("@")
    return f"{head.partition('://')[0]}@{tail}" if at and "://" in head else spec[:200]
