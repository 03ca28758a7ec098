"""How far the labels of a predicate can be trusted, as the demonstrations show it."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.structs.predicates import Predicate


@dataclass(frozen=True, slots=True)
class Reliability:
    """Estimates about one predicate that is read from pictures; all of them are probabilities in [0, 1].

    ``error`` is the probability that a label which says true or false is wrong, ``unknown`` that a label says neither,
    ``initially`` that an atom of the predicate holds in the first state of a demonstration.
    """

    predicate: Predicate
    error: float
    unknown: float
    initially: float

    def __post_init__(self) -> None:
        for name, value in (("error", self.error), ("unknown", self.unknown), ("initially", self.initially)):
            if not 0 <= value <= 1:
                raise ValueError(f"reliability of {self.predicate}: {name} must lie between 0 and 1, found {value}")
