"""One episode of a burger task: skills run to their end, get stuck, or use up the horizon (method 10.2)."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.domains.burger.classifiers import holds
from pix2pred.domains.burger.disturbances import Disturbances
from pix2pred.domains.burger.observe import features_of, observe
from pix2pred.domains.burger.skills import explain, policy_for
from pix2pred.domains.burger.world import SIZE, BurgerWorld, advance
from pix2pred.structs import Action, Application, Atom, Predicate, State
from pix2pred.structs.environment import Step, StepStatus
from pix2pred.structs.samplers import Features

HORIZON = 200
"""Primitive steps in one episode in the published kitchen; in a larger one as many for every cell."""


class BurgerEnvironment:
    """An episode that starts in ``initial``. ``world`` is the ground truth; only states are meant to leave."""

    def __init__(
        self,
        initial: BurgerWorld,
        predicates: Sequence[Predicate],
        goal: Sequence[Atom],
        disturbances: Disturbances | None = None,
    ) -> None:
        self.world = initial
        self.steps = 0
        self._initial = initial
        self._predicates = tuple(predicates)
        self._goal = tuple(goal)
        self._disturbances = disturbances
        self._horizon = HORIZON * initial.size**2 // SIZE**2

    def reset(self) -> None:
        """Start the episode over; the same disturbances would come again."""
        self.world, self.steps = self._initial, 0
        if self._disturbances:
            self._disturbances.reset()

    def observe(self) -> State:
        """The state now."""
        return observe(self.world, self._predicates)

    def features(self) -> Features:
        """Positions now, without drawing."""
        return features_of(self.world)

    def goal_reached(self) -> bool:
        """Whether every goal atom is true of the world now."""
        return all(holds(self.world, atom) for atom in self._goal)

    def execute(self, action: Action) -> Step:
        """Run one skill. It never raises: what cannot work is ``STUCK`` with a sentence about the cause."""
        step = Step(*self._run(Application(action.skill.name, tuple(o.name for o in action.objects))))
        if self._disturbances and not self.goal_reached():
            self.world = self._disturbances(self.world)
        return step

    def _run(self, skill: Application) -> tuple[StepStatus, str]:
        start = self.world
        try:
            policy = policy_for(skill, start)
        except ValueError as error:
            return StepStatus.STUCK, f"{skill} cannot be run: {error}"
        seen = {start}
        while not policy.finished(self.world):
            if self.steps >= self._horizon:
                return (
                    StepStatus.HORIZON,
                    f"{skill} had not ended when the {self._horizon} steps of the episode were used up",
                )
            self.world = advance(self.world, policy(self.world))
            self.steps += 1
            # Policies are deterministic and see the whole world, so a repeated world repeats for ever.
            if self.world in seen:
                return StepStatus.STUCK, f"{skill} never ends: {explain(skill, start)}"
            seen.add(self.world)
        return StepStatus.DONE, ""
