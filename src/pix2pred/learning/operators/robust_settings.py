"""The numbers of the robust learner, each with its unit, its range and the reason for it.

Nothing here is meant to be changed from one data set to the next, and no file or option of a run does so. That is not
the same as there being nothing to choose: the numbers were chosen once, by hand, and where
a field names workloads, on those.
Where a field gives no measurement there was none: it was set once and kept. "Burger workloads" are typed words of the
burger kitchens with 0 to 10 % wrong labels (``benchmarks/noise.py``); "competition workloads" are planning-competition
domains (``benchmarks/competition.py``), seeds 0 to 5.
"""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field


class LabelModelSettings(BaseModel):
    """How true values are inferred from labels that are sometimes wrong (``labels/hidden_markov.py``)."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    slip: float = Field(
        1e-3, gt=0, lt=0.5,
        description="probability that a transition does to one of its own atoms something else than its settled effect."
        " Skills rarely fail in demonstrations; 0 would let one label overrule all others",
    )  # fmt: skip
    drift: float = Field(
        1e-4, gt=0, lt=0.5,
        description="probability that a transition changes an atom it is not about. Below slip: what a skill does not "
        "touch stays; 0 would forbid what no model foresees",
    )  # fmt: skip
    unforeseen: float = Field(
        3e-3, gt=0, lt=0.5,
        description="probability of a change that no class of transitions shows, while classes are not known yet: "
        "between a rate of errors of one in a thousand, where such a change is believed, and of one in fifty, where it"
        " has to be seen twice",
    )  # fmt: skip
    first_change: float = Field(
        0.2, gt=0, lt=1, description="probability of any change of a transition's own atoms when estimation starts: "
        "anything but 0 and 1, from which expectation maximisation cannot move",
    )  # fmt: skip
    change_prior: float = Field(
        0.2, gt=0, description="imagined changes, in transitions, added to what was counted for every role and value"
    )
    change_prior_total: float = Field(
        1.0, gt=0, description="imagined transitions of which change_prior changed: with nothing counted, 0.2 of 1"
    )
    sibling_weight: float = Field(
        2.0, ge=0,
        description="transitions that the same argument of the same skill in other classes counts for, while effects "
        "are free: what placing does to the hand is much the same whatever is placed",
    )  # fmt: skip
    error_rate: float = Field(
        0.05, gt=0, lt=0.5,
        description="share of wrong labels assumed before any is seen, and the most that the pooled rate of all "
        "predicates may become as the prior of each. Chosen by hand: a poor labeller's rate, so that labels"
        " have to earn trust",
    )  # fmt: skip
    least_pooled_rate: float = Field(
        1e-3, gt=0, lt=0.5, description="the least the pooled rate may become: no labeller is taken for perfect"
    )
    prior_labels: float = Field(
        20.0, gt=0, description="labels that the pooled rate counts for in the estimate of one predicate's rate; most "
        "predicates have hundreds",
    )  # fmt: skip
    least_rate: float = Field(
        1e-4, gt=0, lt=0.5, description="smallest error rate of a predicate, so that logarithms exist"
    )
    greatest_rate: float = Field(
        0.45, gt=0, lt=0.5, description="largest error rate of a predicate: at 0.5 labels would say nothing, above it "
        "they would be read as their opposite",
    )  # fmt: skip
    passes: int = Field(
        2, ge=1, description="fits of the whole model, the later ones with the pooled error rate of the one before"
    )
    free_rounds: int = Field(
        6, ge=1,
        description="rounds of expectation maximisation before effects are settled. Chosen by hand: enough for rates "
        "and effects to part, few enough not to fit every coin",
    )  # fmt: skip
    unmixed_rounds: int = Field(
        2, ge=0,
        description="rounds of settling in which an effect may not be mixed. With mixed effects allowed from the first,"
        " errors that happen to fall on one class twice were kept as an effect",
    )  # fmt: skip
    mixed_rounds: int = Field(2, ge=1, description="rounds of settling, after these, in which an effect may be mixed")
    change_penalty: float = Field(
        1.0, ge=0, description="nats that adding or deleting costs beside the Bayesian information criterion: most "
        "skills leave most atoms alone",
    )  # fmt: skip
    mixed_penalty: float = Field(
        3.0, ge=0, description="nats that a mixed effect costs beside the criterion: it splits a class"
    )
    sibling_pull: float = Field(
        3.0, ge=0,
        description="nats by which the other classes of a skill can speak against an effect, at most. With 0, hand-free"
        " was not taken and given back consistently (burger workloads, 10 % wrong)",
    )  # fmt: skip
    precondition_odds: float = Field(
        19.0, gt=1,
        description="odds, before looking, that an atom which a transition deletes holds before it, and that one which "
        "it adds does not",
    )  # fmt: skip
    custom_odds: float = Field(
        99.0, gt=1, description="odds that an atom has, before a transition, the value it always has there"
    )
    custom_rounds: int = Field(
        10, ge=1,
        description="steps of estimating in which share of transitions an atom holds beforehand; the estimate is "
        "followed downhill and need not be exact",
    )  # fmt: skip
    doubt_margin: float = Field(
        1e-4, gt=0, lt=0.5,
        description="probability of being wrong from which on the belief about a value is remembered; below it the "
        "value counts as wrong with this probability (see ``confident``)",
    )  # fmt: skip
    cells: int = Field(
        1 << 18,
        ge=1,
        description="labels treated at a time, which bounds memory: some twenty arrays of this many numbers",
    )


class KindSettings(BaseModel):
    """When a rare kind of transition is taken for a common one with a wrong label (``labels/consistent.py``)."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    imagined_errors: float = Field(
        0.5, gt=0, description="wrong labels imagined beside those that smoothing found: with imagined_labels, 0.5 %"
    )
    imagined_labels: float = Field(100.0, gt=0, description="labels imagined beside those there are")
    kind_cost: float = Field(
        1.5, ge=0, description="nats that one more kind of transition costs, beside what its effects do"
    )
    effect_cost: float = Field(
        2.0, ge=0,
        description="nats for every effect in which a kind differs from another one. With these two a single wrong "
        "label is preferred to a kind that occurs once if labels are wrong in 1 % or more, and two labels are not",
    )  # fmt: skip
    bystander_cost: float = Field(
        2.0, ge=0, description="nats more for every object of such an effect that is no argument of the skill"
    )
    omission: float = Field(
        0.75, ge=0, le=1,
        description="what it costs to lack an effect that the other kind has, as a share of what it costs to have one "
        "more. Below 1, so that of two kinds that differ in an effect the one without it stays",
    )  # fmt: skip
    imagined: float = Field(
        0.5,
        gt=0,
        description="transitions of every kind imagined beside those that were counted (Krichevsky and Trofimov 1981)",
    )
    least_gain: float = Field(1e-6, gt=0, description="nats below which two descriptions are equally long")
    common: int = Field(
        10, ge=1, description="transitions of a kind above which it is no accident, which saves time alone"
    )
    most_differences: int = Field(
        3, ge=1, description="effects in which two kinds may differ to be compared, which bounds what is tried"
    )
    rounds: int = Field(5, ge=1, description="times that all transitions are looked at; usually two are enough")


class RoleSettings(BaseModel):
    """When a class of transitions gets a variable for an object that no argument names (``operators/roles.py``)."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    least_changes: int = Field(
        4, ge=1, description="transitions of a class in which labels show the same change of such an object. Chosen by "
        "hand: fewer equal changes can be equal errors; Coffee's five demonstrations show five",
    )  # fmt: skip
    least_share: float = Field(0.8, gt=0, le=1, description="the same, as a share of the class's transitions")


class RobustSettings(BaseModel):
    """All numbers of the learner that allows for wrong labels."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    labels: LabelModelSettings = Field(default_factory=LabelModelSettings)
    roles: RoleSettings = Field(default_factory=RoleSettings)
    kinds: KindSettings = Field(default_factory=KindSettings)
    confident: float = Field(
        1e-4, gt=0, lt=0.5, description="probability that a value without remembered doubt is wrong, in the test of "
        "preconditions",
    )  # fmt: skip
    unreliable: float = Field(
        0.2, gt=0, le=1,
        description="share of a candidate's labels that are wrong or unforeseeable, above which it is not considered: "
        "at test time it would be wrong as often. Between a poor labeller's 0.1 and a coin's 0.5",
    )  # fmt: skip
    doubt_price: float = Field(
        50.0, ge=0,
        description="arguments that a candidate all of whose labels are wrong costs: two wrong labels in a hundred "
        "weigh as much as one argument more. Preferring few arguments over good labels took "
        "``handled(cell)`` for ``robot-at(robot, cell)`` (competition workloads)",
    )  # fmt: skip
