"""What the home domains share as seen by the rest of the system: demonstrations by a person, tasks for a robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pix2pred.domains import scripted
from pix2pred.domains.home.appearance import described
from pix2pred.domains.home.episode import HomeEnvironment, Rules
from pix2pred.domains.home.world import Machine, World, no_machine
from pix2pred.domains.physics import check_drawing
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Action, Atom, Demo, Task, Vocabulary, parse_application
from pix2pred.structs.environment import Environment, SimulatedTask, SimulatorState

if TYPE_CHECKING:  # geometry in space, which only robots need
    from pix2pred.structs.space.surroundings import Surroundings

Rng = np.random.Generator

MOST_ATOMS = 25
"""Atoms that are kept of what a model proposes about a demonstration."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """A demonstration: where it starts, the skills (``Name(object, ...)`` without the hand) and the goal."""

    name: str
    start: Callable[[Rng], World]
    skills: tuple[str, ...]
    goal: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Start:
    """Where a task starts, and its goal, as ``Predicate(object, ...)``."""

    world: World
    goal: tuple[str, ...]


StartMaker = Callable[[int, Rng], Start]
"""Makes the start of a family's task with the given index."""


class HomeDomain:
    """A domain in the home world (extra ``sim``). All families share their demonstrations."""

    machine: Machine = staticmethod(no_machine)
    """What happens when a robot presses the switch of a machine."""

    def __init__(
        self,
        name: str,
        rules: Rules,
        recipes: Sequence[Recipe],
        families: Mapping[str, StartMaker],
        truth: Callable[[World, str, Sequence[str]], bool],
        settings: Mapping[str, Any],
        reader: Path,
    ) -> None:
        self.name = name
        self.families: Sequence[str] = tuple(families)
        self.reader: Path | None = reader
        self.rules = rules
        self.recipes = tuple(recipes)
        self._starts = dict(families)
        self._truth = truth
        self._settings = dict(settings)

    def check_installed(self) -> None:
        """Raises ``MissingExtraError`` when the simulator is not installed or cannot draw."""
        check_drawing()

    def vocabulary(self, family: str) -> Vocabulary:
        """Types, skills and initial predicates, the same for all families."""
        self._check(family)
        rules = self.rules
        return Vocabulary(self.name, tuple(rules.types.values()), tuple(rules.skills.values()), rules.given)

    def settings(self, family: str) -> Mapping[str, Any]:
        """The published learning settings (method 10.7)."""
        self._check(family)
        return dict(self._settings)

    def asking(self, family: str) -> Mapping[str, Mapping[str, Any]]:
        """Clean pictures, few proposals, and none about the hand that no camera of a robot sees (method 10.4, 10.6)."""
        self._check(family)
        return {"proposal": {"max_atoms": MOST_ATOMS, "exclude": ["hand"], "marks": False}, "labels": {"marks": False}}

    def demonstrations(self, family: str, seed: int) -> Sequence[Demo]:
        """The rendered demonstrations, seen with a person's eyes."""
        self._check(family)
        return tuple(self.demonstration(seed, index) for index in range(len(self.recipes)))

    def demonstration(self, seed: int, index: int) -> Demo:
        """One of the demonstrations."""
        recipe, world = self.recipes[index], self.demonstration_world(seed, index)
        goal = self.goal_of(Start(world, recipe.goal))
        environment = HomeEnvironment(self.rules, world, goal)
        objects = self.rules.objects(world)
        return scripted.demonstrate(recipe.name, environment, objects, self.actions_of(recipe, world), goal)

    def demonstration_starts(self, family: str, seed: int) -> Sequence[SimulatedTask]:
        """The initial states of ``demonstrations(family, seed)``: running their actions visits their states again."""
        self._check(family)
        return tuple(
            self.task(recipe.name, Start(self.demonstration_world(seed, i), recipe.goal))
            for i, recipe in enumerate(self.recipes)
        )

    def demonstration_world(self, seed: int, index: int) -> World:
        """Where a demonstration starts, without looking at it."""
        return described(self.recipes[index].start(scene_generator(seed, Split.DEMONSTRATIONS, 0, index)))

    def start(self, family: str, seed: int, index: int) -> Start:
        """Where a test task starts, without looking at it."""
        self._check(family)
        start = self._starts[family](index, scene_generator(seed, Split.TASKS, self.families.index(family), index))
        return replace(start, world=described(start.world))

    def tasks(self, family: str, seed: int, count: int = 10) -> Sequence[SimulatedTask]:
        """``count`` test tasks, seen through the robot's cameras."""
        return tuple(self.task(f"{family}-test-{i}", self.start(family, seed, i)) for i in range(count))

    def environment(self, task: Task, simulator: SimulatorState, disturb: float = 0.0) -> HomeEnvironment:
        """A fresh episode of a task.

        Raises ``ValueError`` when the simulator state does not belong to the task, and for disturbances, which this
        domain does not have.
        """
        if disturb:
            raise ValueError(f"the {self.name} domain has no disturbances; leave out --disturb")
        if not isinstance(simulator.get("world"), Mapping):
            raise ValueError(f"not a {self.name} simulator state: it needs 'world'")
        world = World.from_dict(simulator["world"])
        unknown = set(world.types().values()) - set(self.rules.types)
        if unknown:
            raise ValueError(f"not a {self.name} simulator state: it has a {min(unknown)}")
        if set(self.rules.objects(world)) != set(task.objects):
            raise ValueError(f"task {task.name}: its objects are not those of the simulator state")
        return HomeEnvironment(self.rules, world, task.goal)

    def concept_holds(self, environment: Environment, concept: str, names: Sequence[str]) -> bool:
        assert isinstance(environment, HomeEnvironment), "an environment of this domain"
        return self._truth(environment.world, concept, names)

    def roaming(self, family: str, seed: int, index: int) -> Surroundings:
        """The start of a test task as the surroundings of a robot that walks; tags hang on the walls."""
        from pix2pred.domains.home.roaming import RoamingHome

        return RoamingHome(self.start(family, seed, index).world, self.machine)

    def actions_of(self, recipe: Recipe, world: World) -> tuple[Action, ...]:
        """The actions of a recipe over the objects of ``world``."""
        by_name = {o.name: o for o in self.rules.objects(world)}
        actions = []
        for text in recipe.skills:
            applied = parse_application(text)
            args = (by_name[world.actor], *(by_name[a] for a in applied.args))
            actions.append(Action(self.rules.skills[applied.name], args))
        return tuple(actions)

    def task(self, name: str, start: Start) -> SimulatedTask:
        """The task that begins in ``start``, with the pictures of its first state."""
        objects = self.rules.objects(start.world)
        goal = self.goal_of(start)
        task = Task(name, objects, self.rules.observe(start.world), goal)
        return SimulatedTask(task, {"world": start.world.to_dict()})

    def goal_of(self, start: Start) -> tuple[Atom, ...]:
        """The goal of a start as atoms."""
        by_name = {o.name: o for o in self.rules.objects(start.world)}
        predicates = {p.name: p for p in self.rules.given}
        applied = [parse_application(text) for text in start.goal]
        return tuple(Atom(predicates[a.name], tuple(by_name[n] for n in a.args)) for a in applied)

    def _check(self, family: str) -> None:
        if family not in self._starts:
            raise ValueError(f"{self.name} has no family {family!r}; choose from {', '.join(self.families)}")
