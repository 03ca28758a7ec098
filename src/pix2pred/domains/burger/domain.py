"""The burger domain as the rest of the system sees it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pix2pred.domains.burger.classifiers import objects_of
from pix2pred.domains.burger.demonstrator import demonstrate
from pix2pred.domains.burger.disturbances import Disturbances
from pix2pred.domains.burger.environment import BurgerEnvironment
from pix2pred.domains.burger.families import BurgerFamily, BurgerRecipe, Variant, bind_atom, load_families
from pix2pred.domains.burger.observe import observe
from pix2pred.domains.burger.scenes import initial_world, sized_recipe
from pix2pred.domains.burger.truth import concept_value
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Demo, Task, Vocabulary
from pix2pred.structs.environment import Environment, SimulatedTask, SimulatorState


class BurgerDomain:
    """Three task families in one grid kitchen, and one in a larger kitchen.

    Every scene is seeded by (seed, split, family index, index).

    ``variant`` selects the test tasks; ``held_z`` is the level of an item held at reset, 1 or, as in the reference, 0.
    """

    name: str = "burger"
    reader: Path | None = Path(__file__).parent / "reader"

    def __init__(self, variant: Variant = "paper", held_z: int = 1) -> None:
        if variant not in ("paper", "reference"):
            raise ValueError(f"variant {variant!r} is neither 'paper' nor 'reference'")
        self.variant: Variant = variant
        self.held_z = held_z
        self.families: Sequence[str] = tuple(load_families())

    def vocabulary(self, family: str) -> Vocabulary:
        """Types, skills and initial predicates of a family."""
        return self._family(family).vocabulary()

    def settings(self, family: str) -> Mapping[str, Any]:
        """The published learning settings of a family (method 10.7)."""
        return dict(self._family(family).settings)

    def demonstrations(self, family: str, seed: int) -> Sequence[Demo]:
        """The 12 rendered demonstrations, in the order of method 12.2."""
        chosen = self._family(self._family(family).shown)
        demos = []
        for index, recipe in enumerate(chosen.demonstrations):
            rng = scene_generator(seed, Split.DEMONSTRATIONS, chosen.index, index)
            world = initial_world(recipe.scene, rng, self.held_z)
            demos.append(demonstrate(f"{chosen.name}-{index:02d}-{recipe.name}", chosen, recipe, world))
        return tuple(demos)

    def tasks(self, family: str, seed: int, count: int = 10) -> Sequence[SimulatedTask]:
        """``count`` test tasks: the first half (rounded up) hand free, the rest holding a raw patty."""
        chosen = self._family(family)
        kinds = chosen.test_recipes(self.variant)
        tasks = []
        for index in range(count):
            recipe = kinds.free if index < (count + 1) // 2 else kinds.holding
            tasks.append(self._task(f"{family}-test-{index}", chosen, recipe, Split.TASKS, seed, index))
        return tuple(tasks)

    def demonstration_starts(self, family: str, seed: int) -> Sequence[SimulatedTask]:
        """The initial states of ``demonstrations(family, seed)``: running their actions visits their states again."""
        chosen = self._family(self._family(family).shown)
        return tuple(
            self._task(f"{chosen.name}-{index:02d}", chosen, recipe, Split.DEMONSTRATIONS, seed, index)
            for index, recipe in enumerate(chosen.demonstrations)
        )

    def sized_tasks(self, family: str, seed: int, count: int, items: int) -> Sequence[SimulatedTask]:
        """``count`` tasks with ``items`` movable things. Raises ``ValueError`` when they do not fit the kitchen."""
        recipe = sized_recipe(items)
        chosen = self._family(family)
        return tuple(
            self._task(f"{family}-{items}-items-{index}", chosen, recipe, Split.SIZED, seed, 1000 * items + index)
            for index in range(count)
        )

    def _task(
        self, name: str, family: BurgerFamily, recipe: BurgerRecipe, split: Split, seed: int, index: int
    ) -> SimulatedTask:
        world = initial_world(recipe.scene, scene_generator(seed, split, family.index, index), self.held_z)
        objects = objects_of(world)
        by_name = {o.name: o for o in objects}
        goal = tuple(bind_atom(a, by_name, family.initial) for a in recipe.goal)
        task = Task(name, objects, observe(world, family.initial), goal)
        return SimulatedTask(task, {"family": family.name, "world": world.to_dict()})

    def concept_holds(self, environment: Environment, concept: str, names: Sequence[str]) -> bool:
        assert isinstance(environment, BurgerEnvironment), "an environment of this domain"
        return concept_value(environment.world, concept, names)

    def environment(self, task: Task, simulator: SimulatorState, disturb: float = 0.0) -> BurgerEnvironment:
        """A fresh episode of a task; with probability ``disturb`` something happens to the scene after a skill.

        Raises ``ValueError`` when the simulator state does not belong to the task.
        """
        if not isinstance(simulator.get("family"), str) or not isinstance(simulator.get("world"), Mapping):
            raise ValueError("not a burger simulator state: it needs 'family' and 'world'")
        family = self._family(simulator["family"])
        world = BurgerWorld.from_dict(simulator["world"])
        if set(objects_of(world)) != set(task.objects):
            raise ValueError(f"task {task.name}: its objects are not those of the simulator state")
        disturbances = Disturbances(disturb, (world.look, int(Split.DISTURBANCES))) if disturb else None
        return BurgerEnvironment(world, family.initial, task.goal, disturbances)

    def _family(self, name: str) -> BurgerFamily:
        families = load_families()
        if name not in families:
            raise ValueError(f"burger has no family {name!r}; choose from {', '.join(families)}")
        return families[name]
