"""What selection gives: the chosen predicates, their operators, and how it came about."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from pix2pred.structs import Operator, Predicate


class ClimbEnd(StrEnum):
    """Why a climb ended."""

    NO_CANDIDATES = "no-candidates"
    """There was nothing to choose from."""

    GOOD_ENOUGH_AT_ONCE = "good-enough-at-once"
    """The stopping rule was content with J before any candidate was tried: a threshold may be too high."""

    GOOD_ENOUGH = "good-enough"
    """The stopping rule was content with J after some candidates were taken."""

    NOTHING_BETTER = "nothing-better"
    """No candidate left lowers J."""

    NOTHING_WORTHWHILE = "nothing-worthwhile"
    """Some lower J, but not by as much as the stopping rule asks for."""

    NOT_SEARCHED = "not-searched"
    """Every candidate was kept without a climb."""


@dataclass(frozen=True, slots=True)
class RunnerUp:
    """A candidate that a step considered and did not take.

    ``j`` is the objective with it, or a lower bound on that when ``exact`` is False.
    """

    predicate: Predicate
    j: float
    exact: bool


@dataclass(frozen=True, slots=True)
class ClimbStep:
    """One step of the climb: what was added (None at the start), the J reached, and the best other candidates."""

    added: Predicate | None
    j: float
    j_demos: tuple[float | None, ...]
    runners_up: tuple[RunnerUp, ...]


@dataclass(frozen=True, slots=True)
class Selection:
    """The result of selecting.

    - ``selected`` are the chosen predicates and ``operators`` those learned with them.
    - ``dropped`` were chosen on the way but are no operator's precondition, or were made superfluous by later ones.
    - ``steps`` tell the climb; the first one is the start.
    - ``identical`` lists, for each selected predicate, the candidates that agree with it everywhere.
    - ``evaluations`` counts candidate sets considered, ``scored`` those whose J had to be computed, ``searches`` the
      planning searches this took and ``budget_hits`` the searches that ran out of nodes.
    - ``pinned`` are selected because a person wants it; ``end`` says why the climb ended.
    """

    selected: tuple[Predicate, ...]
    dropped: tuple[Predicate, ...]
    operators: tuple[Operator, ...]
    steps: tuple[ClimbStep, ...]
    identical: tuple[tuple[Predicate, tuple[Predicate, ...]], ...]
    evaluations: int
    scored: int
    searches: int
    budget_hits: int
    pinned: tuple[Predicate, ...] = ()
    end: ClimbEnd = ClimbEnd.NOT_SEARCHED
