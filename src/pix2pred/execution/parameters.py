"""Which continuous parameters a step of a plan is run with (method 7)."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pix2pred.structs import Action, ExecutedStep, GroundOperator
from pix2pred.structs.environment import Environment, Step
from pix2pred.structs.samplers import Draw, Sampler, UniformSampler


@dataclass(slots=True)
class Parameters:
    """Chooses parameters with the samplers of a model; an operator without one gets any point of its box."""

    samplers: Mapping[str, Sampler]
    rng: np.random.Generator

    @classmethod
    def for_task(cls, samplers: Mapping[str, Sampler], seed: int, task: str) -> Parameters:
        """Parameters drawn from a generator of ``(seed, name of the task)``."""
        words = np.frombuffer(hashlib.sha256(task.encode()).digest(), dtype=np.uint32)
        return cls(samplers, np.random.default_rng(np.random.SeedSequence((seed, *(int(w) for w in words)))))

    def choose(self, ground: GroundOperator, environment: Environment) -> tuple[Action, Draw | None]:
        """The action of ``ground`` in the environment's present state, and how its parameters, if any, were drawn."""
        skill = ground.operator.skill
        if not skill.dimension:
            return Action(skill, ground.skill_objects), None
        sampler = self.samplers.get(ground.operator.name) or UniformSampler(skill.low, skill.high)
        draw = sampler.sample(environment.features(), ground.objects, self.rng)
        return Action(skill, ground.skill_objects, draw.params), draw


def executed(ground: GroundOperator, action: Action, draw: Draw | None, step: Step) -> ExecutedStep:
    """What the episode says of a step."""
    name, rejections = (draw.sampler, draw.rejections) if draw else ("", 0)
    return ExecutedStep(str(action), str(ground), step.status, step.detail, name, rejections)
