"""The skills that a Spot has programs for, and the words for what it holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.structs import Atom, FromDomain, Object, Predicate, Vocabulary

Program = Callable[..., None]
"""Takes the robot and the names of the skill's objects after the robot; raises ``FailedError`` when it fails."""

HAND_EMPTY = "HandEmpty"
"""The predicate of a robot that holds nothing."""


@dataclass(frozen=True)
class Repertoire:
    """``programs`` by the names of skills. ``held`` names the predicate for a thing in the hand by its type.

    No picture shows what is in the hand, nor that it is empty: the robot tells it.
    """

    programs: Mapping[str, Program]
    held: Mapping[str, str]

    def told(self, words: Vocabulary, objects: Sequence[Object], holding: str | None) -> frozenset[Atom]:
        """The given atoms when ``holding`` is in the hand. Raises ``RobotError`` for words that do not fit."""
        predicates: dict[str, Predicate] = {p.name: p for p in words.initial if isinstance(p.source, FromDomain)}
        types = {o.name: o.type.name for o in objects}
        robots = [o for o in objects if o.type.name == "robot"]
        name = HAND_EMPTY if holding is None else self.held.get(types[holding], "")
        if name not in predicates or len(robots) != 1:
            raise RobotError(
                Outcome.NOT_READY, f"{words.name}: one robot and a predicate {name or 'of its hand'!r} needed"
            )
        things = [o for o in objects if o.name == holding]
        return frozenset({Atom(predicates[name], (robots[0], *things))})
