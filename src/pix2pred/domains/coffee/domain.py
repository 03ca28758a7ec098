"""The coffee domain as the rest of the system sees it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pix2pred.domains.coffee.classifiers import objects_of
from pix2pred.domains.coffee.demonstrator import all_filled, demonstrate
from pix2pred.domains.coffee.environment import CoffeeEnvironment
from pix2pred.domains.coffee.families import DEMONSTRATIONS, FAMILIES, CoffeeFamily
from pix2pred.domains.coffee.observe import observe
from pix2pred.domains.coffee.scenes import SIZED, initial_world
from pix2pred.domains.coffee.truth import concept_value
from pix2pred.domains.coffee.vocabulary import GIVEN, SKILLS, TYPES
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.domains.physics import check_drawing
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Demo, Task, Vocabulary
from pix2pred.structs.environment import Environment, SimulatedTask, SimulatorState

SETTINGS: Mapping[str, Any] = {
    "h_pre_frac": 0.8, "h_data_frac": 0.05, "j_threshold": 100, "early_stop": "level",
    "precondition_rule": "at_least", "max_plans": 1000,
}  # fmt: skip
"""The published learning settings (method 6.2, 10.7)."""


class CoffeeDomain:
    """Jug, machine and cups in a MuJoCo scene (extra ``sim``). Scenes are seeded by (seed, split, family, index)."""

    name: str = "coffee"
    reader: Path | None = Path(__file__).parent / "reader"
    families: Sequence[str] = tuple(FAMILIES)

    def check_installed(self) -> None:
        """Raises ``MissingExtraError`` when the simulator is not installed or cannot draw."""
        check_drawing()

    def vocabulary(self, family: str) -> Vocabulary:
        """Types, skills and initial predicates, the same for all families."""
        self._family(family)
        return Vocabulary("coffee", TYPES, SKILLS, GIVEN)

    def settings(self, family: str) -> Mapping[str, Any]:
        """The published learning settings (method 10.7)."""
        self._family(family)
        return dict(SETTINGS)

    def demonstrations(self, family: str, seed: int) -> Sequence[Demo]:
        """The five rendered demonstrations, one with two cups and four with one."""
        chosen = self._family(family)
        return tuple(
            demonstrate(f"coffee-{index}-{recipe.name}", recipe, _demonstration_world(seed, index), chosen.above)
            for index, recipe in enumerate(DEMONSTRATIONS)
        )

    def tasks(self, family: str, seed: int, count: int = 10) -> Sequence[SimulatedTask]:
        """``count`` test tasks: fill every cup; in about half of them the jug's handle is turned away."""
        return self._tasks(f"{family}-test", family, Split.TASKS, seed, count, self._family(family).test_cups)

    def demonstration_starts(self, family: str, seed: int) -> Sequence[SimulatedTask]:
        """The initial states of ``demonstrations(family, seed)``: running their actions visits their states again."""
        self._family(family)
        return tuple(
            self._task(f"coffee-{index}-{recipe.name}", family, _demonstration_world(seed, index))
            for index, recipe in enumerate(DEMONSTRATIONS)
        )

    def sized_tasks(self, family: str, seed: int, count: int, items: int) -> Sequence[SimulatedTask]:
        """``count`` tasks with ``items`` cups. Raises ``ValueError`` when they do not fit the table, or for none."""
        if items < 1:
            raise ValueError(f"a task needs a cup to fill, not {items}")
        return self._tasks(f"{family}-{items}-cups", family, SIZED, seed, count, items)

    def _tasks(self, name: str, family: str, split: int, seed: int, count: int, cups: int) -> Sequence[SimulatedTask]:
        worlds = [initial_world(cups, scene_generator(seed, split, cups, index)) for index in range(count)]
        return tuple(self._task(f"{name}-{index}", family, world) for index, world in enumerate(worlds))

    def _task(self, name: str, family: str, world: CoffeeWorld) -> SimulatedTask:
        objects = objects_of(world)
        initial = observe(world, GIVEN, self._family(family).above)
        task = Task(name, objects, initial, all_filled(objects))
        return SimulatedTask(task, {"family": family, "world": world.to_dict()})

    def concept_holds(self, environment: Environment, concept: str, names: Sequence[str]) -> bool:
        assert isinstance(environment, CoffeeEnvironment), "an environment of this domain"
        return concept_value(environment.world, concept, names)

    def environment(self, task: Task, simulator: SimulatorState, disturb: float = 0.0) -> CoffeeEnvironment:
        """A fresh episode of a task.

        Raises ``ValueError`` when the simulator state does not belong to the task, and for disturbances, which this
        domain does not have.
        """
        if disturb:
            raise ValueError("the coffee domain has no disturbances; leave out --disturb")
        if not isinstance(simulator.get("family"), str) or not isinstance(simulator.get("world"), Mapping):
            raise ValueError("not a coffee simulator state: it needs 'family' and 'world'")
        world = CoffeeWorld.from_dict(simulator["world"])
        if set(objects_of(world)) != set(task.objects):
            raise ValueError(f"task {task.name}: its objects are not those of the simulator state")
        return CoffeeEnvironment(world, GIVEN, task.goal, self._family(simulator["family"]).above)

    def _family(self, name: str) -> CoffeeFamily:
        if name not in FAMILIES:
            raise ValueError(f"coffee has no family {name!r}; choose from {', '.join(FAMILIES)}")
        return FAMILIES[name]


def _demonstration_world(seed: int, index: int) -> CoffeeWorld:
    recipe = DEMONSTRATIONS[index]
    return initial_world(recipe.cups, scene_generator(seed, Split.DEMONSTRATIONS, 0, index), recipe.turned_away)
