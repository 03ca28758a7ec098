"""The kitchen as the rest of the system sees it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np

from pix2pred.domains.kitchen.environment import KitchenEnvironment
from pix2pred.domains.kitchen.vocabulary import (
    KETTLE_BOILING,
    OBJECT_OF,
    OBJECTS,
    PUSH_KETTLE,
    TURN_ON_KNOB,
    VOCABULARY,
)
from pix2pred.domains.kitchen.world import World, standing_world
from pix2pred.structs import Action, Atom, Demo, Task, Vocabulary
from pix2pred.structs.environment import SimulatedTask, SimulatorState, StepStatus

PUSH_ANGLE = np.pi / 9
"""The demonstrator's push at a knob."""

KETTLE_PUSH = (0.0, -0.2, -0.13, 0.0)
"""The demonstrator's push at the kettle: from 20 cm before it, 13 cm below its handle, straight away."""

LEFT, RIGHT = -0.269, 0.169
"""x of the kettle's start in demonstrations and in tests, in metres."""


class Split(IntEnum):
    """The second number of a seed: what the scene is for."""

    DEMONSTRATIONS = 0
    TASKS = 1


class KitchenDomain:
    """Boil a kettle: demonstrations on the back left burner, tests on the back right one."""

    name: str = "kitchen"
    families: Sequence[str] = ("boil",)
    reader: Path | None = Path(__file__).parent / "reader"

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
        return tuple(_demonstrate(f"{family}-{i:02d}", _start(seed, Split.DEMONSTRATIONS, i, LEFT)) for i in range(3))

    def tasks(self, family: str, seed: int, count: int = 10) -> Sequence[SimulatedTask]:
        """Tasks with the kettle in front on the right: boil it on burner 3."""
        self._check(family)
        goal = _boiling("3")
        tasks = []
        for index in range(count):
            world = _start(seed, Split.TASKS, index, RIGHT)
            initial = KitchenEnvironment(world, goal).observe()
            tasks.append(SimulatedTask(Task(f"{family}-test-{index}", OBJECTS, initial, goal), world.to_dict()))
        return tuple(tasks)

    def environment(self, task: Task, simulator: SimulatorState, disturb: float = 0.0) -> KitchenEnvironment:
        """A fresh episode of a task. Raises ``ValueError`` when the simulator state is not one of the kitchen."""
        if disturb:
            raise ValueError("the kitchen knows no disturbances")
        if set(task.objects) != set(OBJECTS):
            raise ValueError(f"task {task.name}: its objects are not those of the kitchen")
        return KitchenEnvironment(World.from_dict(simulator), task.goal)

    def _check(self, family: str) -> None:
        if family not in self.families:
            raise ValueError(f"kitchen has no family {family!r}; choose from {', '.join(self.families)}")


def _start(seed: int, split: Split, index: int, x: float) -> World:
    rng = np.random.default_rng(np.random.SeedSequence((seed, int(split), index)))
    return standing_world(x, float(rng.uniform(0.4, 0.55)))


def _boiling(number: str) -> tuple[Atom, ...]:
    return (KETTLE_BOILING(OBJECT_OF["kettle"], OBJECT_OF[f"burner{number}"], OBJECT_OF[f"knob{number}"]),)


def _demonstrate(name: str, world: World) -> Demo:
    gripper, kettle = OBJECT_OF["gripper"], OBJECT_OF["kettle"]
    actions = (
        Action(TURN_ON_KNOB, (gripper, OBJECT_OF["knob4"]), (PUSH_ANGLE,)),
        Action(PUSH_KETTLE, (gripper, kettle, OBJECT_OF["burner4"]), KETTLE_PUSH),
    )
    goal = _boiling("4")
    environment = KitchenEnvironment(world, goal)
    states = [environment.observe()]
    for action in actions:
        step = environment.execute(action)
        if step.status is not StepStatus.DONE:
            raise RuntimeError(f"demonstration {name}: {step.detail}")
        states.append(environment.observe())
    if not environment.goal_reached():
        raise RuntimeError(f"demonstration {name}: the kettle does not boil")
    return Demo(name, OBJECTS, tuple(states), actions, goal)
