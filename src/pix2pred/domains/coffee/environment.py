"""One episode of a coffee task: skills run to their end, fail, or use up the horizon (method 10.3)."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.domains.coffee.classifiers import AboveCup, holds
from pix2pred.domains.coffee.observe import features_of, observe
from pix2pred.domains.coffee.simulation.motion import advance
from pix2pred.domains.coffee.simulation.render import render_pixels
from pix2pred.domains.coffee.skills import explain, script_for
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.structs import Action, Application, Atom, Predicate, State
from pix2pred.structs.environment import FrameSink, Step, StepStatus
from pix2pred.structs.samplers import Features

HORIZON = 2000
"""Primitive steps in one episode."""

_STEPS_PER_FRAME = 2


class CoffeeEnvironment:
    """An episode that starts in ``initial``. ``world`` is the ground truth; only states are meant to leave.

    ``above`` decides when jug and robot count as above a cup.
    """

    def __init__(
        self, initial: CoffeeWorld, predicates: Sequence[Predicate], goal: Sequence[Atom], above: AboveCup
    ) -> None:
        self.world = initial
        self.steps = 0
        self._initial = initial
        self._predicates = tuple(predicates)
        self._goal = tuple(goal)
        self._above = above
        self._sink: FrameSink | None = None

    def reset(self) -> None:
        """Start the episode over."""
        self.world, self.steps = self._initial, 0

    def observe(self) -> State:
        """The state now."""
        return observe(self.world, self._predicates, self._above)

    def features(self) -> Features:
        """Places and angles now, without drawing."""
        return features_of(self.world)

    def film(self, sink: FrameSink | None) -> None:
        """From now on hand ``sink`` a frame for every second step; ``None`` stops."""
        self._sink = sink

    def goal_reached(self) -> bool:
        """Whether every goal atom is true of the world now."""
        return all(holds(self.world, atom, self._above) for atom in self._goal)

    def execute(self, action: Action) -> Step:
        """Run one skill. It never raises: what cannot work is ``STUCK`` with a sentence about the cause."""
        skill = Application(action.skill.name, tuple(o.name for o in action.objects))
        start = self.world
        try:
            script = script_for(skill, start)
        except ValueError as error:
            return Step(StepStatus.STUCK, f"{skill} cannot be run: {error}")
        if action.params:
            return Step(StepStatus.STUCK, f"{skill} cannot be run: it takes no parameters, found {len(action.params)}")
        if script.finished(start):
            return Step(StepStatus.DONE)
        for move in script.moves:
            # a move goes on until nothing changes: the gripper has arrived and no coffee flows
            while (after := advance(self.world, move)) != self.world:
                if self.steps >= HORIZON:
                    return Step(StepStatus.HORIZON, f"{skill} had not ended when the {HORIZON} steps were used up")
                self.world = after
                self.steps += 1
                if self._sink and self.steps % _STEPS_PER_FRAME == 0:
                    self._sink(render_pixels(self.world))
                if script.stops and script.finished(self.world):
                    break
        if script.finished(self.world):
            return Step(StepStatus.DONE)
        return Step(StepStatus.STUCK, f"{skill} failed: {explain(skill, start, self.world)}")
