"""The cleanup domain as the rest of the system sees it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pix2pred.domains.cleanup.families import FAMILIES, RECIPES
from pix2pred.domains.cleanup.rules import RULES
from pix2pred.domains.cleanup.truth import concept_value
from pix2pred.domains.home.domain import HomeDomain

SETTINGS: Mapping[str, Any] = {"h_pre_frac": 1.0, "h_data_frac": 0.4, "j_threshold": 100}
"""The published learning settings (method 10.7), which the published learner uses."""


class CleanupDomain(HomeDomain):
    """Clear and wipe tables, fill and dump bins."""

    def __init__(self) -> None:
        super().__init__("cleanup", RULES, RECIPES, FAMILIES, concept_value, SETTINGS, Path(__file__).parent / "reader")
