"""Hosted models on the command line: ``openai:gpt-4o``, ``openai-compatible:MODEL@URL``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from pix2pred.vlm.answers.replay import AbsentVLM
from pix2pred.vlm.control.breaker import BreakerVLM
from pix2pred.vlm.control.budget import BudgetVLM
from pix2pred.vlm.control.estimate import CHARACTERS_PER_TOKEN
from pix2pred.vlm.control.flow import FlowVLM
from pix2pred.vlm.control.guard import Forecast, GuardVLM
from pix2pred.vlm.hosted.pricing import dollars
from pix2pred.vlm.hosted.provider import HostedModel, Provider
from pix2pred.vlm.model_spec import Kind, ModelNameError, ModelSpec, Rates, Setup
from pix2pred.vlm.request import VLM, Request, Spent

if TYPE_CHECKING:
    from pix2pred.vlm.hosted.client import HostedVLM


def kind_of(provider: Provider) -> Kind:
    """The provider's models as a kind that ``--vlm`` can name."""
    return Kind(provider.form, lambda rest: HostedSpec(hosted_model(provider, rest)))


@dataclass(frozen=True, slots=True)
class HostedSpec(ModelSpec):
    """A model behind HTTP."""

    model: HostedModel

    def connect(self, setup: Setup) -> VLM:
        """The model behind what paces it, counts its cost and stops when it is of no use."""
        from pix2pred.vlm.hosted.client import HostedVLM

        hosted = HostedVLM(self.model, setup.draw, setup.flow)
        spending = setup.spending
        asked: VLM = BudgetVLM(hosted, spending.max_requests, spending.max_cost)
        if spending.estimate:
            asked = GuardVLM(asked, spending.estimate, setup.flow.beyond_estimate, self._most(hosted))
        flowing = FlowVLM(asked, setup.flow)
        hosted.hold = flowing.hold
        return BreakerVLM(flowing, setup.flow.unusable_in_a_row)

    def _most(self, hosted: HostedVLM) -> Forecast:
        """What gives the most that a question to ``hosted`` can take."""
        rates = self.rates

        def most(request: Request) -> Spent:
            tokens = len(request.text) // CHARACTERS_PER_TOKEN
            tokens += sum(rates.picture_tokens(*view.shown_size) for view in request.views)
            budget = hosted.budget(request)
            return Spent(tokens, budget, rates.dollars(tokens, budget))

        return most

    def by_name(self, setup: Setup) -> VLM:
        return AbsentVLM(self.model.name)

    @property
    def rates(self) -> Rates:
        return HostedRates(self.model)


@dataclass(frozen=True, slots=True)
class HostedRates:
    """What a hosted model counts and costs, by its provider's rules and the price list at hand."""

    model: HostedModel

    def picture_tokens(self, width: int, height: int) -> int:
        return self.model.provider.picture_tokens(width, height)

    def thinking_tokens(self) -> int:
        return self.model.provider.thinking_tokens(self.model.model)

    def cached_tokens(self, repeated: int) -> int:
        return self.model.provider.cached_tokens(repeated)

    def dollars(self, input_tokens: int, output_tokens: int) -> float | None:
        return dollars(self.model.provider.name, self.model.model, input_tokens, output_tokens)


def hosted_model(provider: Provider, rest: str) -> HostedModel:
    """The model named by what follows ``PROVIDER:``. Raises ``ModelNameError`` for an address that is none."""
    if not provider.has_address:
        return HostedModel(provider, rest)
    model, at, tail = rest.partition("@http")
    url = f"http{tail}"
    try:
        parts = urlsplit(url)
        complete = parts.scheme in ("http", "https") and parts.hostname and (parts.port is None or parts.port > 0)
        secret = parts.username or parts.password or parts.query
    except ValueError:  # a broken port or IPv6 address, characters that another form of the address turns into "/"
        complete, secret = False, None
    if secret:
        raise ModelNameError(
            "--vlm: an address with a name, password or key in it would be written into the run folder; "
            f"put the key into the environment variable {provider.keys_in_words}"
        )
    if not at or not model or not complete or any(c.isspace() for c in url):
        raise ModelNameError(
            f"--vlm {provider.name}:{model[:100]}@...: is not {provider.form} with an address such as "
            f"{provider.name}:qwen2.5-vl@http://localhost:8000/v1"
        )
    return HostedModel(provider, model, url.rstrip("/"))
