"""Any domain as a ``gymnasium.Env`` at skill level: one step runs one skill.

    import gymnasium, pix2pred.gym_envs
    env = gymnasium.make("pix2pred/Kitchen-v0")

Importing this module registers the environments; ``make("pix2pred.gym_envs:pix2pred/Kitchen-v0")`` does it itself.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.envs.registration import register

from pix2pred.registry import REGISTRY, check_family
from pix2pred.structs import Action, Object, Pixels
from pix2pred.structs.environment import Environment, SimulatedTask, StepStatus

_LARGEST = 1e6
MOST_SKILLS = 50
"""Skills after which an episode is cut off."""


def register_all() -> None:
    """Tell gymnasium of every domain, under names such as ``pix2pred/Kitchen-v0``."""
    for name in REGISTRY.domain_names():
        register(
            id=f"pix2pred/{name.title().replace('_', '')}-v0",
            entry_point="pix2pred.gym_envs:DomainEnv",
            kwargs={"domain": name},
            max_episode_steps=MOST_SKILLS,
        )


class DomainEnv(gymnasium.Env[dict[str, Any], dict[str, Any]]):
    """A task of a domain; every reset makes another one of the same size.

    An action is the index of a skill, the indices of objects (as many as the skill takes are read, in its order), and
    continuous parameters scaled to [-1, 1] over the skill's box (as many as it has are read). An observation is the
    first camera's picture and the objects' features, padded with zeros. The reward is 1 when the goal is reached,
    which ends the episode, else 0. An action whose objects do not fit its skill changes nothing; ``info`` says so.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 1}  # noqa: RUF012

    def __init__(self, domain: str, family: str | None = None, render_mode: str | None = None) -> None:
        self._domain = REGISTRY.domain(domain)
        self._family = family or self._domain.families[0]
        check_family(self._domain, self._family)
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode {render_mode!r}: only 'rgb_array' can be drawn")
        self.render_mode = render_mode
        self.skills = self._domain.vocabulary(self._family).skills
        self._task = self._domain.tasks(self._family, 0, 1)[0]
        self._environment: Environment = self._domain.environment(self._task.task, self._task.simulator)
        self._size = len(self._task.task.objects)
        self._width = max(len(o.type.features) for o in self._task.task.objects)
        self._dimension = max(s.dimension for s in self.skills)
        self._arity = max(len(s.types) for s in self.skills)
        self._pixels: Pixels = self._task.task.initial.pictures[0].image.pixels()
        parts: dict[str, spaces.Space[Any]] = {
            "skill": spaces.Discrete(len(self.skills)),
            "objects": spaces.MultiDiscrete([self._size] * self._arity),
        }
        if self._dimension:
            parts["params"] = spaces.Box(-1.0, 1.0, (self._dimension,), np.float32)
        self.action_space = spaces.Dict(parts)
        self.observation_space = spaces.Dict(
            {
                "image": spaces.Box(0, 255, self._pixels.shape, np.uint8),
                "features": spaces.Box(-_LARGEST, _LARGEST, (self._size, self._width), np.float64),
            }
        )

    @property
    def objects(self) -> tuple[Object, ...]:
        """The objects of the present task; their positions are their indices in actions."""
        return self._task.task.objects

    def action(self, name: str, objects: tuple[str, ...], params: tuple[float, ...] = ()) -> dict[str, Any]:
        """The element of the action space that runs skill ``name`` with these objects and parameters."""
        index = next(i for i, s in enumerate(self.skills) if s.name == name)
        skill = self.skills[index]
        names = [o.name for o in self.objects]
        chosen = np.zeros(self._arity, dtype=np.int64)
        chosen[: len(objects)] = [names.index(o) for o in objects]
        built: dict[str, Any] = {"skill": np.int64(index), "objects": chosen}
        if self._dimension:
            scaled = np.zeros(self._dimension, dtype=np.float32)
            low, high = np.array(skill.low), np.array(skill.high)
            scaled[: skill.dimension] = 2 * (np.array(params) - low) / (high - low) - 1
            built["params"] = scaled
        return built

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """A new task, seeded by ``seed``."""
        super().reset(seed=seed)
        self._task = self._new_task()
        self._environment = self._domain.environment(self._task.task, self._task.simulator)
        self._environment.reset()
        return self._observe(), self._info("", "")

    def step(self, action: dict[str, Any]) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Run one skill."""
        skill = self.skills[int(action["skill"])]
        objects = tuple(self.objects[int(i)] for i in action["objects"][: len(skill.types)])
        if all(o.type.is_a(t) for o, t in zip(objects, skill.types, strict=True)):
            scaled = np.asarray(action.get("params", ()), dtype=float)[: skill.dimension]
            params = np.array(skill.low) + (np.clip(scaled, -1, 1) + 1) / 2 * (np.array(skill.high) - skill.low)
            step = self._environment.execute(Action(skill, objects, tuple(float(p) for p in params)))
            status, detail = str(step.status), step.detail
        else:
            status, detail = str(StepStatus.STUCK), f"{skill} does not take ({', '.join(o.name for o in objects)})"
        reached = self._environment.goal_reached()
        truncated = status == StepStatus.HORIZON and not reached
        return self._observe(), float(reached), reached, truncated, self._info(status, detail)

    def render(self) -> Any:
        """The picture now, shape (height, width, 3)."""
        return self._pixels if self.render_mode == "rgb_array" else None

    def _new_task(self) -> SimulatedTask:
        return self._domain.tasks(self._family, int(self.np_random.integers(2**31)), 1)[0]

    def _observe(self) -> dict[str, Any]:
        state = self._environment.observe()
        self._pixels = state.pictures[0].image.pixels()
        features = np.zeros((self._size, self._width))
        for i, item in enumerate(self.objects):
            values = state.features.get(item, ())
            features[i, : len(values)] = values
        return {"image": self._pixels, "features": features}

    def _info(self, status: str, detail: str) -> dict[str, Any]:
        goal = [str(atom) for atom in self._task.task.goal]
        return {
            "status": status, "detail": detail, "goal": goal, "objects": [o.name for o in self.objects]
        }  # fmt: skip


register_all()
