"""What every simulated domain does with a script: check its skills against the scene, and demonstrate it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from pix2pred.structs import Action, Application, Atom, Demo, Object, Skill, Type
from pix2pred.structs.environment import Environment, StepStatus


def demonstrate(
    name: str, environment: Environment, objects: tuple[Object, ...], actions: Iterable[Action], goal: tuple[Atom, ...]
) -> Demo:
    """The states before and after each action, from where ``environment`` stands.

    Raises ``RuntimeError`` when an action fails or the goal is not reached.
    """
    script = tuple(actions)
    states = [environment.observe()]
    for action in script:
        step = environment.execute(action)
        if step.status is not StepStatus.DONE:
            raise RuntimeError(f"demonstration {name}: {action} failed: {step.detail}")
        states.append(environment.observe())
    if not environment.goal_reached():
        raise RuntimeError(f"demonstration {name}: its script does not reach the goal")
    return Demo(name, objects, tuple(states), script, goal)


def check_skill(skill: Application, skills: Mapping[str, Skill], scene: Mapping[str, Type]) -> None:
    """Raise ``ValueError`` unless ``skill`` is one of ``skills``, with things of ``scene`` of the right types."""
    known = skills.get(skill.name)
    if known is None:
        raise ValueError(f"there is no skill {skill.name!r} here; known are {', '.join(skills)}")
    if len(skill.args) != len(known.types):
        raise ValueError(f"{known} takes {len(known.types)} objects, found {len(skill.args)}")
    for name, wanted in zip(skill.args, known.types, strict=True):
        if name not in scene:
            raise ValueError(f"{name!r} is not in this scene")
        if not scene[name].is_a(wanted):
            raise ValueError(f"{name} is a {scene[name].name}, and {known} needs a {wanted.name} in its place")
