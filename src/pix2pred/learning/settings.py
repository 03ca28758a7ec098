"""Settings of operator learning and selection: published values (method 10.7), and the robust learner as default."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer

from pix2pred.learning.strategies import LEARNERS, OBJECTIVES, STOPPING_RULES


def _one_of(names: Collection[str]) -> Callable[[str], str]:
    def check(name: str) -> str:
        if name not in names:
            raise ValueError(f"should be one of {', '.join(names)}")
        return name

    return check


class LearningSettings(BaseModel):
    """How operators are learned and predicates selected. Frozen; saved with every run."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    operators: Annotated[str, AfterValidator(_one_of(LEARNERS))] = Field(
        "robust", description="how operators are learned: robust, allowing for wrong labels, or cluster-and-intersect, "
        "as published; h_pre_frac, h_data_frac, j_threshold and early_stop are of the latter",
        json_schema_extra={"enum": list(LEARNERS)},
    )  # fmt: skip
    h_pre_frac: float = Field(
        0.8, ge=0, le=1, description="share of a class's transitions in which a precondition must hold"
    )
    h_data_frac: float = Field(
        0.05, ge=0, le=1, description="share of a skill's transitions below which a class is dropped"
    )
    j_threshold: float = Field(2000.0, ge=0, description="J_thresh of the early stop (burger domains: 2000)")
    early_stop: Annotated[str, AfterValidator(_one_of(STOPPING_RULES))] = Field(
        "level", json_schema_extra={"enum": list(STOPPING_RULES)},
        description="stop when J <= j_threshold (level), when J fell by at most j_threshold (improvement), or when "
        "nothing explains enough (explained; always with robust)",
    )  # fmt: skip
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
    engine: Annotated[str, AfterValidator(_one_of(OBJECTIVES))] = Field(
        "grouped", json_schema_extra={"enum": list(OBJECTIVES)},
        description="how J is computed: grouped by expected counts, exact-tree by the search of section 6.2 to the "
        "letter",
    )  # fmt: skip
    tie_seed: int = Field(0, ge=0, description="seed of the random tie-break; used by exact-tree")

    lift_types: bool = Field(
        False, description="give variables the types that skills declare where the evidence does not tell their "
        "subtypes apart; learn turns it on for projects without a simulator; published: off",
    )  # fmt: skip

    @model_serializer(mode="wrap")
    def _without_what_is_off(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Types that are not lifted are not mentioned: such a run's files are those of before the option was there."""
        written: dict[str, Any] = serialize(self)
        if not self.lift_types:
            written.pop("lift_types", None)
        return written

    @property
    def strictly_more(self) -> bool:
        """Whether a precondition must hold in more than the share ``h_pre_frac``."""
        return self.precondition_rule == "more_than"

    @property
    def drops_superseded(self) -> bool:
        """Whether predicates that later ones made superfluous are dropped."""
        return self.superseded == "drop"
