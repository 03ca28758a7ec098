"""How states are labelled."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.structs import Atom, Label
from pix2pred.structs.views import LONGEST_SIDE


class LabelProtocol(StrEnum):
    """How a model is asked. PUBLISHED: state by state, as in the paper. FRUGAL: words with definitions, and all states
    of a demonstration in one question."""

    PUBLISHED = "published"
    FRUGAL = "frugal"


class LabelSettings(BaseModel):
    """How states are labelled."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    protocol: LabelProtocol = Field(LabelProtocol.PUBLISHED, description="how a model is asked, proposals included")
    states_per_query: int = Field(
        10, ge=2, le=50, description="frugal: most states that one question shows; 10 pictures fit every provider"
    )
    words_per_meaning: int = Field(
        3, ge=1, le=9, description="frugal: words asked for each meaning at test time, of which the majority decides"
    )
    style: Literal["cot", "terse"] = Field("cot", description="explanations in the first state, or none")
    double_check: bool = Field(True, description="second query after t = 0, in training only")
    crops: bool = Field(True, description="also show the part of the scene the skill was about, before and after")
    marks: bool = Field(True, description="write object names into the pictures (simulation: yes, photos: no)")
    longest_side: int = Field(LONGEST_SIDE, ge=64, le=4096, description="pixels, of a shown picture (paper: 512)")
    missing: Literal["carry_previous", "false"] = Field(
        "carry_previous", description="value of an atom that no answer gives one after t = 0 (at t = 0: false)"
    )
    max_atoms_per_query: int | None = Field(None, ge=1, description="split longer lists of atoms")
    attempts: int = Field(3, ge=1, description="queries before atoms without a value are given up")
    hints: tuple[str, ...] = Field((), description="sentences about the domain added to later-state queries")
    temperature: float = Field(0.0, ge=0, le=2, description="of the model's sampling (paper: 0)")
    votes: int = Field(1, ge=1, le=99, description="samples per query; the majority decides")
    vote_temperature: float = Field(0.7, ge=0, le=2, description="at least this, when there are several samples")
    logprobs: bool = Field(False, description="ask for token probabilities and keep them as confidence, where given")
    structured: bool = Field(False, description="ask for JSON that follows a schema, where the model can do that")

    @property
    def sampling_temperature(self) -> float:
        """The temperature of labelling queries: samples that are to differ need one."""
        return self.temperature if self.votes == 1 else max(self.temperature, self.vote_temperature)

    @property
    def explains(self) -> bool:
        """Whether the first state's question asks for explanations."""
        return self.style == "cot"

    def carried(self, values: Mapping[Atom, Label]) -> Mapping[Atom, Label]:
        """What stands for atoms that no answer gives a value, when they had ``values`` before; the rest are false."""
        return values if self.missing == "carry_previous" else {}
