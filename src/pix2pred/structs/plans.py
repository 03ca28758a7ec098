"""Plans, episodes and changes of atoms: what planning and execution give back."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from pix2pred.structs.goals.opposites import is_denial
from pix2pred.structs.operators import GroundOperator
from pix2pred.structs.predicates import Atom
from pix2pred.structs.states import AbstractState


class PlanStatus(StrEnum):
    """How a search ended. Not found and not findable are different things."""

    SOLVED = "solved"
    UNSOLVABLE = "unsolvable"
    BUDGET = "budget"
    """The search used up what it may create: there may be a plan
    all the same."""
    NOT_FOUND = "not found"
    """An incomplete search came to its end; external planners
    alone."""
    TIMEOUT = "timeout"
    """The clock stopped it; external planners alone."""


@dataclass(frozen=True, slots=True)
class PlanResult:
    """The outcome of planning; ``nodes`` counts created search nodes (``None``: an external planner does not tell).

    ``seconds`` is wall time; it decides nothing except an external planner's TIMEOUT. ``goal`` is the one that was
    planned for, where a task has several.
    """

    status: PlanStatus
    plan: tuple[GroundOperator, ...]
    nodes: int | None
    seconds: float
    goal: tuple[Atom, ...] | None = None


class Failure(StrEnum):
    """Why a task was not solved."""

    WRONG_LABEL = "wrong label"
    WRONG_MODEL = "wrong model"
    NO_PLAN = "no plan"
    BUDGET = "budget"
    SKILL = "skill failure"
    HORIZON = "horizon"
    UNDETERMINED = "undetermined"


class Turn(StrEnum):
    """Why a step of an episode was chosen."""

    FOLLOWED = "the plan goes on"
    PLANNED_AGAIN = "the plan was made anew"
    REPEATED = "the skill had failed and is tried again"
    OTHERWISE = "another way is tried because a skill failed again and again"
    ASSUMED = "the plan rests on what is in doubt"
    CAUTIOUS = "the plan avoids to rest on what is in doubt"
    BY_ANALOGY = "a skill is tried with a kind of object that it was never shown with"


class WhyAsked(StrEnum):
    """Why an atom was asked about again."""

    IN_DOUBT = "the plan rests on it and its value is in doubt"
    SURPRISE = "it is not as the plan expects it"
    """The last skill should have made it otherwise, so that either
    the skill failed or the label is wrong."""
    NO_PLAN = "there would be a plan if it were otherwise"


@dataclass(frozen=True, slots=True)
class Question:
    """An atom asked about again in the state with number ``state``.

    ``before`` and ``after`` are the probabilities that it holds, before the first answer and after the last;
    ``answers`` are true, false or unknown. ``changed`` says that the state from which planning goes on changed.
    """

    state: int
    atom: Atom
    why: WhyAsked
    answers: tuple[str, ...]
    before: float
    after: float
    changed: bool


@dataclass(frozen=True, slots=True)
class ExecutedStep:
    """One skill of an episode: what was run and how it ended.

    For a skill with continuous parameters also which sampler chose them, and how many draws it rejected before.
    ``observed`` are the changes seen afterwards, ``+`` for what became true; None where nobody looked. ``turn`` says
    why the step was chosen, ``because`` which atoms were the reason.
    """

    action: str
    operator: str
    status: str
    detail: str
    sampler: str = ""
    rejections: int = 0
    observed: tuple[str, ...] | None = None
    turn: Turn = Turn.FOLLOWED
    because: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Episode:
    """One task tried once. ``failure`` is None exactly when the task was solved.

    ``labels`` are the visual atoms the (first) plan rests on; ``label_errors`` lists labels known to be
    wrong, where a ground truth exists; ``replans`` counts plans made after the first. ``questions`` are the atoms asked
    about again; ``suspects`` those whose labels contradict all else that is known. Episodes of before have neither.
    """

    task: str
    failure: Failure | None
    detail: str
    plan: tuple[str, ...]
    steps: tuple[ExecutedStep, ...]
    labels: tuple[Atom, ...]
    label_errors: tuple[str, ...]
    nodes: int | None
    replans: int = 0
    questions: tuple[Question, ...] = ()
    suspects: tuple[Atom, ...] = ()

    @property
    def solved(self) -> bool:
        """Whether the true goal was reached."""
        return self.failure is None


@dataclass(frozen=True, slots=True)
class Change:
    """An atom that became true (``holds``) or false; written with a sign, as ``+On(a,b)``."""

    atom: Atom
    holds: bool

    def __str__(self) -> str:
        return f"{'+' if self.holds else '-'}{self.atom}"


def changes(added: Iterable[Atom], deleted: Iterable[Atom]) -> tuple[Change, ...]:
    """The changes that make ``added`` true and ``deleted`` false: those that add first, each group sorted by atom.

    That an atom's opposite becomes false or true is no change of its own.
    """
    gained, lost = (sorted(a for a in atoms if not is_denial(a)) for atoms in (added, deleted))
    return (*(Change(a, True) for a in gained), *(Change(a, False) for a in lost))


def changes_between(before: AbstractState, after: AbstractState) -> tuple[Change, ...]:
    """What differs between two states."""
    return changes(after - before, before - after)


def effects(step: GroundOperator) -> tuple[Change, ...]:
    """What a step is expected to change."""
    return changes(step.add, step.delete)


def signed(found: Iterable[Change]) -> tuple[str, ...]:
    """The changes as text, for files and people."""
    return tuple(str(change) for change in found)
