"""The four skills as closed-loop policies over primitive actions (method 10.2).

A skill looks at the world before every primitive action: it ends when its own purpose is fulfilled, else it walks by a
shortest path to a cell beside its target, turns to face it, and acts. Nothing checks preconditions: a skill started in
the wrong situation acts all the same and never ends.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.domains.burger.vocabulary import SKILL_OF, TYPE_OF
from pix2pred.domains.burger.world import BurgerPrimitive, BurgerWorld, Cell, Heading
from pix2pred.domains.scripted import check_skill
from pix2pred.structs import Application

INTERACT = BurgerPrimitive(interact=True)
TOGGLE = BurgerPrimitive(toggle=True)


@dataclass(frozen=True, slots=True)
class Policy:
    """A skill with its objects bound: what it walks to, what it does there, and when it is done."""

    target: str
    act: BurgerPrimitive
    finished: Callable[[BurgerWorld], bool]

    def __call__(self, world: BurgerWorld) -> BurgerPrimitive:
        """The next primitive action."""
        goal = world.where(self.target)
        if goal == world.faced:
            return self.act
        for heading in Heading:
            if world.cell.toward(heading) == goal:
                return BurgerPrimitive(turn=heading)
        return walk(world, goal)


def walk(world: BurgerWorld, goal: Cell) -> BurgerPrimitive:
    """The first step of a shortest path to a cell beside ``goal``; stands still when there is none.

    Breadth-first search over free interior cells; among equals the order up, left, down, right decides.
    """
    queue: deque[tuple[Cell, Heading]] = deque((world.cell.toward(h), h) for h in Heading)
    seen = {world.cell}
    while queue:
        cell, first = queue.popleft()
        if cell in seen or not world.walkable(cell) or world.stack(cell):
            continue
        seen.add(cell)
        if any(cell.toward(h) == goal for h in Heading):
            return BurgerPrimitive.move(first)
        queue.extend((cell.toward(h), first) for h in Heading)
    return BurgerPrimitive()


def policy_for(skill: Application, world: BurgerWorld) -> Policy:
    """The policy of ``skill``. Raises ``ValueError`` for an unknown skill, or objects that are absent or do not fit."""
    check_skill(skill, SKILL_OF, {name: TYPE_OF[t] for name, t in world.types().items()})
    item = skill.args[1]
    match skill.name:
        case "Pick":
            return Policy(item, TOGGLE, lambda w: w.held == item)
        case "Place":
            target = skill.args[2]
            return Policy(target, TOGGLE, lambda w: w.held is None and w.supports(target, item))
        case _:
            return Policy(item, INTERACT, lambda w: w.thing(item).prepared)


def explain(skill: Application, world: BurgerWorld) -> str:
    """Why ``skill`` could not end when it was started in ``world``."""
    item = skill.args[1]
    match skill.name:
        case "Pick":
            cover = world.cover(item)
            if world.held is not None:
                return f"the hand already held {world.held}"
            return f"{cover} lay on {item}" if cover else f"{item} could not be reached"
        case "Place":
            target = skill.args[2]
            if world.held != item:
                return f"{item} was not held (in the hand: {world.held or 'nothing'})"
            if item == target or target == world.robot:
                return f"{item} cannot be put on {target}"
            cover = world.cover(target)
            return f"{cover} lay on {target}" if cover else f"{target} could not be reached"
        case _:
            station = skill.args[2]
            return f"{item} did not lie directly on {station}"
