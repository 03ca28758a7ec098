"""Which continuous parameters a step of a plan is run with (method 7)."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from pix2pred.structs import Action, ExecutedStep, GroundOperator, Task
from pix2pred.structs.environment import Environment, Step
from pix2pred.structs.samplers import Draw, Sampler, UniformSampler

Announce = Callable[[GroundOperator, Action], None]
"""Told which step of a plan is run next."""


def tell_nobody(ground: GroundOperator, action: Action) -> None:
    """The announcement nobody hears."""


@dataclass(slots=True)
class Parameters:
    """Chooses parameters with the samplers of a model; an operator without one gets any point of its box."""

    samplers: Mapping[str, Sampler]
    rng: np.random.Generator
    announce: Announce = tell_nobody

    @classmethod
    def for_task(
        cls, samplers: Mapping[str, Sampler], seed: int, task: Task, announce: Announce = tell_nobody
    ) -> Parameters:
        """Parameters drawn from a generator of the seed, the task's name and its initial features."""
        start = sorted((o.name, values) for o, values in task.initial.features.items())
        words = np.frombuffer(hashlib.sha256(f"{task.name}{start}".encode()).digest(), dtype=np.uint32)
        return cls(samplers, np.random.default_rng(np.random.SeedSequence((seed, *(int(w) for w in words)))), announce)

    def choose(self, ground: GroundOperator, environment: Environment) -> tuple[Action, Draw | None]:
        """Announces and gives the action of ``ground`` in the present state, and how its parameters were drawn."""
        skill = ground.operator.skill
        action, draw = ground.action, None
        if skill.dimension:
            sampler = self.samplers.get(ground.operator.name) or UniformSampler(skill.low, skill.high)
            draw = sampler.sample(environment.features(), ground.objects, self.rng)
            action = replace(action, params=draw.params)
        self.announce(ground, action)
        return action, draw


def executed(ground: GroundOperator, action: Action, draw: Draw | None, step: Step) -> ExecutedStep:
    """What the episode says of a step."""
    name, rejections = (draw.sampler, draw.rejections) if draw else ("", 0)
    return ExecutedStep(str(action), str(ground), step.status, step.detail, name, rejections)
