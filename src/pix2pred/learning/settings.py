"""Settings of operator learning and selection, with the published values (method 10.7)."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class LearningSettings(BaseModel):
    """How operators are learned and predicates selected. Frozen; saved with every run."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    operators: Literal["cluster-and-intersect", "robust"] = Field(
        "cluster-and-intersect", description="how operators are learned: as published, or allowing for wrong labels"
    )
    h_pre_frac: float = Field(
        0.8, ge=0, le=1, description="share of a class's transitions in which a precondition must hold"
    )
    h_data_frac: float = Field(
        0.05, ge=0, le=1, description="share of a skill's transitions below which a class is dropped"
    )
    j_threshold: float = Field(2000.0, ge=0, description="J_thresh of the early stop (burger domains: 2000)")
    early_stop: Literal["level", "improvement"] = Field(
        "level", description="stop when J <= j_threshold (level) or when J fell by at most j_threshold (improvement)"
    )
    precondition_rule: Literal["at_least", "more_than"] = Field(
        "at_least", description="count/n >= h_pre_frac, or > with h_pre_frac = 1 meaning all"
    )
    superseded: Literal["drop", "keep"] = Field(
        "drop", description="what becomes of a predicate without which J still meets the early stop; published: keep"
    )
    static_demos: int = Field(
        2, ge=0, description="demonstrations within which a predicate that never changes must tell objects apart; "
        "published: 0",
    )  # fmt: skip
    max_plans: int = Field(200, ge=1, description="skeletons considered per demonstration (K of section 6.2)")
    node_budget: int = Field(
        100_000, ge=1, description="search nodes per demonstration; stands in for the paper's wall-clock limit"
    )
    engine: Literal["grouped", "exact-tree"] = Field(
        "grouped", description="how J is computed: expected counts, or the search of section 6.2 to the letter"
    )
    tie_seed: int = Field(0, ge=0, description="seed of the random tie-break; used by exact-tree")

    def required_count(self, n: int) -> int:
        """In how many of ``n`` transitions an atom must hold to become a precondition (method 5.4)."""
        h = self.h_pre_frac
        if self.precondition_rule == "more_than" and h < 1:
            return int(h * n + 1e-9) + 1
        return -int(-(h * n - 1e-9) // 1)
