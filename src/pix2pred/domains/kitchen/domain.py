"""The kitchen as the rest of the system sees it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pix2pred.domains import scripted
from pix2pred.domains.kitchen.environment import KitchenEnvironment
from pix2pred.domains.kitchen.model import scene_file
from pix2pred.domains.kitchen.scenes import LEFT, RIGHT, boiling, push_kettle, start_world, turn_on
from pix2pred.domains.kitchen.truth import value_now
from pix2pred.domains.kitchen.vocabulary import OBJECTS, VOCABULARY
from pix2pred.domains.kitchen.world import KitchenWorld
from pix2pred.domains.physics import check_drawing
from pix2pred.domains.seeds import Split
from pix2pred.structs import Demo, Task, Vocabulary
from pix2pred.structs.environment import Environment, SimulatedTask, SimulatorState

DEMONSTRATIONS = 3


class KitchenDomain:
    """Boil a kettle: demonstrations on the back left burner, tests on the back right one."""

    name: str = "kitchen"
    families: Sequence[str] = ("boil",)
    reader: Path | None = Path(__file__).parent / "reader"

    def check_installed(self) -> None:
        """Raises ``MissingExtraError`` when the simulator is not installed or cannot draw."""
        check_drawing()
        scene_file()

    def vocabulary(self, family: str) -> Vocabulary:
        """Types, skills and given predicates."""
        self._check(family)
        return VOCABULARY

    def settings(self, family: str) -> Mapping[str, Any]:
        """The published learning settings (method 10.7)."""
        self._check(family)
        return {"h_pre_frac": 0.8, "h_data_frac": 0.05, "j_threshold": 100}

    def demonstrations(self, family: str, seed: int) -> Sequence[Demo]:
        """Three demonstrations: turn on knob 4, push the kettle onto burner 4."""
        self._check(family)
        return tuple(
            _demonstrate(f"{family}-{i:02d}", start_world(seed, Split.DEMONSTRATIONS, i, LEFT))
            for i in range(DEMONSTRATIONS)
        )

    def tasks(self, family: str, seed: int, count: int = 10) -> Sequence[SimulatedTask]:
        """Tasks with the kettle in front on the right: boil it on burner 3."""
        self._check(family)
        return tuple(
            _task(f"{family}-test-{index}", start_world(seed, Split.TASKS, index, RIGHT), "3") for index in range(count)
        )

    def demonstration_starts(self, family: str, seed: int) -> Sequence[SimulatedTask]:
        """The initial states of ``demonstrations(family, seed)``: running their actions visits their states again."""
        self._check(family)
        return tuple(
            _task(f"{family}-{i:02d}", start_world(seed, Split.DEMONSTRATIONS, i, LEFT), "4")
            for i in range(DEMONSTRATIONS)
        )

    def concept_holds(self, environment: Environment, concept: str, names: Sequence[str]) -> bool:
        assert isinstance(environment, KitchenEnvironment), "an environment of this domain"
        return value_now(environment, concept, names)

    def environment(self, task: Task, simulator: SimulatorState, disturb: float = 0.0) -> KitchenEnvironment:
        """A fresh episode of a task. Raises ``ValueError`` when the simulator state is not one of the kitchen."""
        if disturb:
            raise ValueError("the kitchen knows no disturbances")
        if set(task.objects) != set(OBJECTS):
            raise ValueError(f"task {task.name}: its objects are not those of the kitchen")
        return KitchenEnvironment(KitchenWorld.from_dict(simulator), task.goal)

    def _check(self, family: str) -> None:
        if family not in self.families:
            raise ValueError(f"kitchen has no family {family!r}; choose from {', '.join(self.families)}")


def _task(name: str, world: KitchenWorld, number: str) -> SimulatedTask:
    goal = boiling(number)
    return SimulatedTask(Task(name, OBJECTS, KitchenEnvironment(world, goal).observe(), goal), world.to_dict())


def _demonstrate(name: str, world: KitchenWorld) -> Demo:
    goal = boiling("4")
    actions = (turn_on("4"), push_kettle("4"))
    return scripted.demonstrate(name, KitchenEnvironment(world, goal), OBJECTS, actions, goal)
