"""The juice domain as the rest of the system sees it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pix2pred.domains.home.domain import HomeDomain
from pix2pred.domains.juice.families import FAMILIES, RECIPES
from pix2pred.domains.juice.machine import switched
from pix2pred.domains.juice.rules import RULES
from pix2pred.domains.juice.truth import concept_value

SETTINGS: Mapping[str, Any] = {"h_pre_frac": 1.0, "h_data_frac": 0.4, "j_threshold": 0}
"""The published learning settings (method 10.7), which the published learner uses."""


class JuiceDomain(HomeDomain):
    """Juice fruit into cups."""

    machine = staticmethod(switched)

    def __init__(self) -> None:
        super().__init__("juice", RULES, RECIPES, FAMILIES, concept_value, SETTINGS, Path(__file__).parent / "reader")
