"""Which estimators samplers are made of."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.learning.samplers.learn import SamplerFitter, fit_gaussian
from pix2pred.learning.samplers.networks import fit_networks


class SamplerSettings(BaseModel):
    """How samplers of continuous parameters are learned."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    estimators: Literal["gaussian", "torch"] = Field(
        "gaussian", description="gaussian: linear and Bayesian; torch: the paper's two networks (extra torch)"
    )

    def fitter(self) -> SamplerFitter:
        """What makes a sampler of examples."""
        return {"gaussian": fit_gaussian, "torch": fit_networks}[self.estimators]
