"""Vocabularies, demonstrations and tasks (method 1.4)."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.structs.objects import Object, Type
from pix2pred.structs.predicates import Atom, Predicate
from pix2pred.structs.skills import Action, Skill
from pix2pred.structs.states import State


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What is known of a domain, called ``name``, before anything is learned.

    ``initial`` are the predicates that are given and need not be invented.
    """

    name: str
    types: tuple[Type, ...]
    skills: tuple[Skill, ...]
    initial: tuple[Predicate, ...]


@dataclass(frozen=True, slots=True)
class Demo:
    """A demonstration: what was there, what was done, and how it looked.

    The state with number t + 1 is seen after the action with number t, so that there is one state more than there are
    actions. In the last one ``goal`` holds, a conjunction of atoms, of which some may say what must not hold, or one of
    ``alternatives``, goals like it. Raises ``ValueError`` for other numbers.
    """

    name: str
    objects: tuple[Object, ...]
    states: tuple[State, ...]
    actions: tuple[Action, ...]
    goal: tuple[Atom, ...]
    alternatives: tuple[tuple[Atom, ...], ...] = ()

    def __post_init__(self) -> None:
        if len(self.states) != len(self.actions) + 1:
            raise ValueError(
                f"demonstration {self.name}: {len(self.actions)} actions need {len(self.actions) + 1} states, "
                f"found {len(self.states)}"
            )

    @property
    def goals(self) -> tuple[tuple[Atom, ...], ...]:
        """All conjunctions of which one holds in the last state."""
        return (self.goal, *self.alternatives)


@dataclass(frozen=True, slots=True)
class Task:
    """What is to be reached, and from where.

    ``goal`` is a conjunction of atoms, of which some may say what must not hold (``structs.goals``). Reaching one of
    ``alternatives``, goals like it, is as good. ``initial`` is seen, and labelled before planning.
    """

    name: str
    objects: tuple[Object, ...]
    initial: State
    goal: tuple[Atom, ...]
    alternatives: tuple[tuple[Atom, ...], ...] = ()

    @property
    def goals(self) -> tuple[tuple[Atom, ...], ...]:
        """All conjunctions of which one is to be reached."""
        return (self.goal, *self.alternatives)
