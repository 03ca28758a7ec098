"""The coffee domain as the rest of the system sees it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pix2pred.domains.coffee.classifiers import objects_of
from pix2pred.domains.coffee.demonstrator import all_filled, demonstrate
from pix2pred.domains.coffee.environment import CoffeeEnvironment
from pix2pred.domains.coffee.families import DEMONSTRATIONS, FAMILIES, Family
from pix2pred.domains.coffee.observe import observe
from pix2pred.domains.coffee.scenes import Split, initial_world, scene_generator
from pix2pred.domains.coffee.vocabulary import GIVEN, SKILLS, TYPES
from pix2pred.domains.coffee.world import World
from pix2pred.structs import Demo, Task, Vocabulary
from pix2pred.structs.environment import SimulatedTask, SimulatorState

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
        demos = []
        for index, recipe in enumerate(DEMONSTRATIONS):
            rng = scene_generator(seed, Split.DEMONSTRATIONS, 0, index)
            world = initial_world(recipe.cups, rng, recipe.turned_away)
            demos.append(demonstrate(f"coffee-{index}-{recipe.name}", recipe, world, chosen.above))
        return tuple(demos)

    def tasks(self, family: str, seed: int, count: int = 10) -> Sequence[SimulatedTask]:
        """``count`` test tasks: fill every cup; in about half of them the jug's handle is turned away."""
        chosen = self._family(family)
        tasks = []
        for index in range(count):
            world = initial_world(chosen.test_cups, scene_generator(seed, Split.TASKS, chosen.test_cups, index))
            objects = objects_of(world)
            task = Task(f"{family}-test-{index}", objects, observe(world, GIVEN, chosen.above), all_filled(objects))
            tasks.append(SimulatedTask(task, {"family": family, "world": world.to_dict()}))
        return tuple(tasks)

    def environment(self, task: Task, simulator: SimulatorState, disturb: float = 0.0) -> CoffeeEnvironment:
        """A fresh episode of a task.

        Raises ``ValueError`` when the simulator state does not belong to the task, and for disturbances, which this
        domain does not have.
        """
        if disturb:
            raise ValueError("the coffee domain has no disturbances; leave out --disturb")
        if not isinstance(simulator.get("family"), str) or not isinstance(simulator.get("world"), Mapping):
            raise ValueError("not a coffee simulator state: it needs 'family' and 'world'")
        world = World.from_dict(simulator["world"])
        if set(objects_of(world)) != set(task.objects):
            raise ValueError(f"task {task.name}: its objects are not those of the simulator state")
        return CoffeeEnvironment(world, GIVEN, task.goal, self._family(simulator["family"]).above)

    def _family(self, name: str) -> Family:
        if name not in FAMILIES:
            raise ValueError(f"coffee has no family {name!r}; choose from {', '.join(FAMILIES)}")
        return FAMILIES[name]
