"""Vocabularies, demonstrations and tasks (method 1.4)."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.structs.objects import Object, Type
from pix2pred.structs.predicates import Atom, Predicate
from pix2pred.structs.skills import Action, Skill
from pix2pred.structs.states import State


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What is known of a domain before learning: types, skills and the initial predicates."""

    name: str
    types: tuple[Type, ...]
    skills: tuple[Skill, ...]
    initial: tuple[Predicate, ...]


@dataclass(frozen=True, slots=True)
class Demo:
    """Objects, k+1 states around k actions, and a goal that holds in the last state."""

    name: str
    objects: tuple[Object, ...]
    states: tuple[State, ...]
    actions: tuple[Action, ...]
    goal: tuple[Atom, ...]

    def __post_init__(self) -> None:
        if len(self.states) != len(self.actions) + 1:
            raise ValueError(
                f"demonstration {self.name}: {len(self.actions)} actions need {len(self.actions) + 1} states, "
                f"found {len(self.states)}"
            )


@dataclass(frozen=True, slots=True)
class Task:
    """Objects, an initial state and a goal over the initial predicates."""

    name: str
    objects: tuple[Object, ...]
    initial: State
    goal: tuple[Atom, ...]
