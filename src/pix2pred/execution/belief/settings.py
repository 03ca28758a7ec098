"""The numbers of the belief, with their reasons."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class BeliefSettings:
    """How a belief weighs what it is told. All fields are probabilities unless said otherwise.

    Labels. ``error`` stands in for the error rate of a predicate of which the world model has no estimate (models of
    before); ``prior_labels`` is the number of labels for which the model's estimate counts while the labels of the
    episode itself are counted. ``sticky`` is the probability that an error belongs to the picture rather than to the
    question, so that asking again repeats it; nobody knows it beforehand, hence one half. ``misread`` is the
    probability that an atom is always misread: it bounds what any number of equal labels can show.

    Skills. ``fails`` is the probability that a skill whose preconditions hold and which reports success did not have
    its effects, ``fails_unreported`` the same before anybody reports (a person who executes it does not). ``noticed``
    is the probability that a skill without its effects reports failure, ``false_alarm`` that one with them does.
    ``works_without`` is the probability that a skill works although a learned precondition does not hold: some learned
    preconditions are superfluous. ``unseen`` is the probability that given effects are not seen although the skill
    worked (the scene was disturbed). ``drift`` is the probability, per skill, that an atom changes which the skill does
    not mention.

    ``doubt`` is the probability of being wrong from which on an atom is in doubt, and ``unlikely`` the one below which
    nothing is done for the sake of an atom. ``certain`` bounds every probability away from 0 and 1.
    ``suspect_after`` is the number of looks in which a label contradicts everything else known about its atom, and
    never agreed with it, before the atom is suspected of being misread for good.
    """

    error: float = 0.02
    prior_labels: float = 50.0
    initially: float = 0.5
    sticky: float = 0.5
    misread: float = 0.005
    fails: float = 0.005
    fails_unreported: float = 0.05
    noticed: float = 0.9
    false_alarm: float = 0.003
    works_without: float = 0.5
    unseen: float = 0.05
    drift: float = 0.01
    doubt: float = 0.1
    unlikely: float = 0.001
    certain: float = 0.0003
    suspect_after: int = 3


DEFAULTS = BeliefSettings()
