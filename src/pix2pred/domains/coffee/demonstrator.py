"""Runs a script of skills through an episode and records it as a demonstration (method 1.4)."""

from __future__ import annotations

from pix2pred.domains import scripted
from pix2pred.domains.coffee.classifiers import AboveCup, objects_of
from pix2pred.domains.coffee.environment import CoffeeEnvironment
from pix2pred.domains.coffee.families import CoffeeRecipe
from pix2pred.domains.coffee.vocabulary import CUP_FILLED, GIVEN, SKILL_OF
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.structs import Action, Atom, Demo, Object


def actions_of(recipe: CoffeeRecipe, world: CoffeeWorld) -> tuple[Action, ...]:
    """The actions of ``recipe`` over the objects of ``world``."""
    by_name = {o.name: o for o in objects_of(world)}
    return tuple(
        Action(SKILL_OF[name], (by_name["robot"], *(by_name[a] for a in args))) for name, *args in recipe.skills
    )


def all_filled(objects: tuple[Object, ...]) -> tuple[Atom, ...]:
    """The goal: every cup is filled."""
    return tuple(CUP_FILLED(o) for o in objects if o.type.name == "cup")


def demonstrate(name: str, recipe: CoffeeRecipe, initial: CoffeeWorld, above: AboveCup) -> Demo:
    """The demonstration of ``recipe`` from ``initial``: the states before and after each skill.

    Raises ``RuntimeError`` when a skill of the script fails or the goal is not reached.
    """
    objects = objects_of(initial)
    goal = all_filled(objects)
    environment = CoffeeEnvironment(initial, GIVEN, goal, above)
    return scripted.demonstrate(name, environment, objects, actions_of(recipe, initial), goal)
