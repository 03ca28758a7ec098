"""The task families as data (method 10.2, order of demonstrations 12.2): reads ``families.yaml``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from typing import Any, Literal

import yaml

from pix2pred.domains.burger.vocabulary import (
    SHARED,
    SKILL_OF,
    SKILLS,
    STATION,
    TYPE_OF,
    TYPES,
    composites,
    find_predicate,
)
from pix2pred.domains.burger.world import SIZE
from pix2pred.structs import Action, Application, Atom, Object, Predicate, Vocabulary, parse_application

Variant = Literal["paper", "reference"]
"""Which test tasks: those the paper describes or those of the reference (they differ for Combo, method 10.2)."""


@dataclass(frozen=True, slots=True)
class SceneContents:
    """What a scene holds: ``(name, type name)`` sorted by name, what starts on what, and what is held.

    ``size`` are the cells along one side of the kitchen.
    """

    things: tuple[tuple[str, str], ...]
    start: Mapping[str, str] = field(default_factory=dict)
    held: str | None = None
    size: int = SIZE


@dataclass(frozen=True, slots=True)
class BurgerRecipe:
    """A scene, the skills to run in it (none for a test task), and the goal, all by name."""

    name: str
    scene: SceneContents
    goal: tuple[Application, ...]
    skills: tuple[Application, ...] = ()


@dataclass(frozen=True, slots=True)
class TaskKinds:
    """The two kinds of test task of a family.

    The robot starts with its hand ``free``, or ``holding`` a raw patty.
    """

    free: BurgerRecipe
    holding: BurgerRecipe


@dataclass(frozen=True, slots=True)
class BurgerFamily:
    """A task family as the file describes it.

    ``index`` is its place there and enters the seeds of its tasks; ``shown`` is the family whose demonstrations it has;
    ``tests`` are kinds of test task by their variant, ``settings`` the published settings of learning.
    """

    name: str
    index: int
    shown: str
    initial: tuple[Predicate, ...]
    demonstrations: tuple[BurgerRecipe, ...]
    tests: Mapping[str, TaskKinds]
    settings: Mapping[str, Any]

    def vocabulary(self) -> Vocabulary:
        """Types, skills and initial predicates."""
        return Vocabulary("burger", TYPES, SKILLS, self.initial)

    def test_recipes(self, variant: Variant) -> TaskKinds:
        """The test tasks of ``variant``; families with one variant use it for both."""
        return self.tests.get(variant, self.tests["paper"])


def bind_atom(application: Application, objects: Mapping[str, Object], predicates: Sequence[Predicate]) -> Atom:
    """The atom written as ``application``, with the signature that fits the objects."""
    args = tuple(objects[name] for name in application.args)
    return Atom(find_predicate(predicates, application.name, args), args)


def bind_action(application: Application, objects: Mapping[str, Object]) -> Action:
    """The action written as ``application``."""
    return Action(SKILL_OF[application.name], tuple(objects[name] for name in application.args))


@cache
def load_families() -> Mapping[str, BurgerFamily]:
    """All families by name, in the order of the file."""
    text = resources.files("pix2pred.domains.burger").joinpath("families.yaml").read_text(encoding="utf-8")
    data = yaml.safe_load(text)
    order = list(data)
    return {name: _family(name, order, data) for name in order}


def _family(name: str, order: Sequence[str], families: Mapping[str, Any]) -> BurgerFamily:
    """A family; what it does not say itself is that of the family it is ``like``."""
    own = families[name]
    model = own.get("like", name)
    data = {**families[model], **own}
    recipes = {key: _recipe(key, entry) for key, entry in data["recipes"].items()}
    demonstrations = [
        recipes[key] for block in data["demonstrations"] for _ in range(block["times"]) for key in block["cycle"]
    ]
    tests = {
        variant: TaskKinds(_recipe("free", kinds["free"]), _recipe("holding", kinds["holding"]))
        for variant, kinds in data["tests"].items()
    }
    initial = (*SHARED, *composites(data["composites"]))
    return BurgerFamily(name, order.index(name), model, initial, tuple(demonstrations), tests, data["settings"])


def _recipe(name: str, data: Mapping[str, Any]) -> BurgerRecipe:
    things = sorted(
        (type_name if TYPE_OF[type_name].is_a(STATION) else f"{type_name}{number}", type_name)
        for type_name, count in data["scene"].items()
        for number in range(1, count + 1)
    )
    return BurgerRecipe(
        name,
        SceneContents(tuple(things), data.get("start", {}), data.get("held"), data.get("size", SIZE)),
        tuple(parse_application(text) for text in data["goal"]),
        tuple(parse_application(text) for text in data.get("skills", ())),
    )
