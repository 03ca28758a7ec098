"""Executing a plan together with a person: they run a skill and take a photo, we look, compare, and plan again.

The person may do and see what a simulated environment does in ``episode``; the plan is followed by the same rules.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from pix2pred.execution.doubtful import that_of
from pix2pred.execution.explaining.missing import Missing, missing
from pix2pred.execution.explaining.scene import PlannedScene, listed
from pix2pred.execution.pursuit import GivenUpError, MayAssume, Pursuit, assume_nothing
from pix2pred.predicates import StateLabels
from pix2pred.structs import AbstractState, Action, Atom, FromVLM, GroundOperator, State
from pix2pred.structs.environment import StepStatus
from pix2pred.structs.plans import Change, changes, changes_between, effects


@dataclass(frozen=True, slots=True)
class SeenStep:
    """What one executed step was expected to change, and what was seen to.

    ``absent`` was expected and not seen, ``surplus`` seen and not expected; changes have a sign. ``assumed`` are the
    changes that no photo shows and nobody told. ``replanned`` says that the plan goes on from here anew.
    """

    step: GroundOperator
    action: Action
    state: State
    labels: StateLabels
    seen: AbstractState
    expected: tuple[Change, ...]
    absent: tuple[Change, ...]
    surplus: tuple[Change, ...]
    assumed: tuple[Change, ...]
    replanned: bool = False


class Guided:
    """One task, executed step by step by somebody else. ``step`` is the next one; None when it is over.

    ``ended`` is empty while there is a step, and when the goal seems to hold; else it says why there is none. When
    there is no other plan than one that rests on what is probably not so, ``may_assume`` decides whether it is tried.
    """

    def __init__(self, scene: PlannedScene, *, may_assume: MayAssume = assume_nothing) -> None:
        self.scene = scene
        self.seen = scene.seen
        self.looks: list[SeenStep] = []
        self.step: GroundOperator | None = None
        self.ended = ""
        self._pursuit = Pursuit(
            partial(scene.solver.plan_from, scene.asked),
            that_of(scene.result, scene.asked.goals),
            scene.result.plan,
            scene.perception,
            may_assume=may_assume,
        )
        if scene.solved:
            self._advance()
        else:
            self.ended = f"there is no plan ({scene.result.status})"

    @property
    def remaining(self) -> tuple[GroundOperator, ...]:
        """The steps that the present plan still has, the next one first."""
        return () if self.step is None else tuple(self._pursuit.plan[self._pursuit.position :])

    @property
    def replans(self) -> int:
        """How many plans were made after the first."""
        return self._pursuit.replans

    @property
    def reached(self) -> bool:
        """Whether the goal holds in what was seen last."""
        return any(self.seen.issuperset(goal) for goal in self.scene.asked.goals)

    @property
    def missing(self) -> tuple[Missing, ...]:
        """When it is over without success: goal atoms that cannot be reached from what was seen last, and why."""
        if self.step is not None or self.reached or not self.looks:
            return ()
        task = self.scene.task
        return missing(self.scene.solver.operators(task), task.objects, self.seen, task.goal)

    @property
    def expected_listed(self) -> tuple[Change, ...]:
        """The changes of the next step that no photo can show: a person has to confirm them."""
        return () if self.step is None else changes(listed(self.step.add), listed(self.step.delete))

    def told(self, state: State, happened: Sequence[Change]) -> State:
        """``state`` with the given atoms that hold when, of ``expected_listed``, these changes ``happened``."""
        assert self.step is not None, "there is a step to tell about"
        given = set(listed(self.seen))
        given -= {change.atom for change in happened if not change.holds}
        given |= {change.atom for change in happened if change.holds}
        return replace(state, given=frozenset(given))

    def observe(self, state: State, *, told: bool, reported: StepStatus | None = None) -> SeenStep:
        """The next step was tried, and ``state`` is what came of it; ``told``: its given atoms are all that hold.

        Otherwise those are carried over, with the changes expected of the step if whatever should show, shows.
        ``reported`` is how it ended, where somebody says so.
        """
        step = self.step
        assert step is not None, "there is a step to observe"
        before, kept = self.seen, listed(self.seen)
        state = state if told else replace(state, given=kept)
        after = self.scene.perception.advance(step, state, reported)
        assumed: tuple[Change, ...] = ()
        if not told and _visible(step.add) <= after and not _visible(step.delete) & after:
            given = (kept - step.delete) | listed(step.add)
            assumed = changes_between(kept, given)
            after = self.scene.perception.relist(given)
        look = SeenStep(
            step, step.action, state, self.scene.perception.labels, after,
            effects(step),
            changes(step.add - after, step.delete & after),
            changes(after - before - step.add, before - after - step.delete),
            assumed,
        )  # fmt: skip
        self.seen = after
        replans = self.replans
        self._pursuit.executed(before, succeeded=step.add <= after)
        self._advance()
        self.looks.append(replace(look, replanned=self.replans > replans))
        return self.looks[-1]

    def _advance(self) -> None:
        try:
            self.step = self._pursuit.next()
        except GivenUpError as error:
            self.step, self.ended = None, str(error)


def _visible(atoms: frozenset[Atom]) -> AbstractState:
    return frozenset(a for a in atoms if isinstance(a.predicate.source, FromVLM))
