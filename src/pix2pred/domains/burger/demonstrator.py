"""Runs a script of skills through an episode and records it as a demonstration (method 1.4)."""

from __future__ import annotations

from pix2pred.domains import scripted
from pix2pred.domains.burger.classifiers import objects_of
from pix2pred.domains.burger.environment import BurgerEnvironment
from pix2pred.domains.burger.families import BurgerFamily, BurgerRecipe, bind_action, bind_atom
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.structs import Demo


def demonstrate(name: str, family: BurgerFamily, recipe: BurgerRecipe, initial: BurgerWorld) -> Demo:
    """The demonstration of ``recipe`` from ``initial``: the states before and after each skill.

    Raises ``RuntimeError`` when a skill of the script fails or the goal is not reached.
    """
    objects = objects_of(initial)
    by_name = {o.name: o for o in objects}
    goal = tuple(bind_atom(a, by_name, family.initial) for a in recipe.goal)
    environment = BurgerEnvironment(initial, family.initial, goal)
    return scripted.demonstrate(name, environment, objects, (bind_action(a, by_name) for a in recipe.skills), goal)
